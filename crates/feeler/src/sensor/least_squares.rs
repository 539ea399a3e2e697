//! What fits by least squares share.

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};

/// Least width of a range of inputs over which a slope makes sense.
pub(super) const LEAST_SLOPE_RANGE: f64 = 1e-12;

/// Largest distance beyond a range, in widths of it, over which a force goes on growing.
const FARTHEST: f64 = 1e6;

/// How far `input` lies outside of `range`, signed; limited so that forces stay finite however far
/// it is. Not a number where `input` is none.
pub(super) fn beyond(input: f64, [low, high]: [f64; 2]) -> f64 {
    let farthest = FARTHEST * (high - low);
    let outside = if input > high {
        input - high
    } else if input < low {
        input - low
    } else if input.is_nan() {
        input
    } else {
        0.0
    };
    if outside > farthest {
        farthest
    } else if outside < -farthest {
        -farthest
    } else {
        outside
    }
}

/// The product of a row of three terms with itself: its share of the normal equations.
pub(super) fn outer(row: DVec3) -> DMat3 {
    DMat3::from_cols(row.x * row, row.y * row, row.z * row)
}

/// The combination of `columns` that is nearest to `forces`.
///
/// # Errors
/// When there are not more rows than columns, or a column follows from the others.
pub(super) fn least_squares(columns: DMatrix<f64>, forces: &[f64]) -> Result<Vec<f64>, String> {
    /// Least part of a column that the columns before it may leave, relative to the largest.
    const LEAST_PART: f64 = 1e-9;
    let (rows, terms) = columns.shape();
    if rows <= terms {
        return Err(format!("more than {terms} loads expected, got {rows}"));
    }
    let all_finite = columns.iter().chain(forces).all(|v| v.is_finite());
    if !all_finite {
        return Err("loads and pictures of finite numbers expected".into());
    }
    let decomposition = columns.qr();
    let triangle = decomposition.r();
    let (least, largest) = (triangle.diagonal().abs().min(), triangle.amax());
    if least <= LEAST_PART * largest {
        return Err(format!("at least {terms} different loads expected"));
    }
    let mut solution = DVector::from_column_slice(forces);
    decomposition.q_tr_mul(&mut solution);
    let solved = triangle.solve_upper_triangular(&solution.rows(0, terms));
    let solution = solved.ok_or("loads that determine the coefficients expected")?;
    Ok(solution.iter().copied().collect())
}
