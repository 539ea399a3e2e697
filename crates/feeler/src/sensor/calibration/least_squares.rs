//! Shared functions of least-squares fits.

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};

/// Minimum width of an input's range for fitting a slope.
pub(in crate::sensor) const MIN_SLOPE_RANGE: f64 = 1e-12;

/// Maximum extrapolation beyond a range, in multiples of its width.
const FARTHEST: f64 = 1e6;

/// Signed distance from `input` to the nearest end of `range`; 0 inside. Limited so that forces stay finite. NaN if
/// `input` is NaN.
pub(in crate::sensor) fn beyond(input: f64, [low, high]: [f64; 2]) -> f64 {
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

/// Outer product of a row of three terms with itself: its contribution to the normal equations.
pub(in crate::sensor) fn outer(row: DVec3) -> DMat3 {
    DMat3::from_cols(row.x * row, row.y * row, row.z * row)
}

/// Coefficients of the linear combination of `columns` that best approximates `forces`.
///
/// # Errors
/// If there are no more rows than columns, or the columns are linearly dependent.
pub(in crate::sensor) fn least_squares(
    columns: DMatrix<f64>,
    forces: &[f64],
) -> Result<Vec<f64>, String> {
    /// Minimum diagonal element of R in the QR decomposition, relative to the largest element; below it, a column is
    /// linearly dependent.
    const MIN_PART: f64 = 1e-9;
    let (rows, terms) = columns.shape();
    if rows <= terms {
        return Err(format!("expected more than {terms} loads, got {rows}"));
    }
    let all_finite = columns.iter().chain(forces).all(|v| v.is_finite());
    if !all_finite {
        return Err("expected loads and images with finite values".into());
    }
    let decomposition = columns.qr();
    let triangle = decomposition.r();
    let (least, largest) = (triangle.diagonal().abs().min(), triangle.amax());
    if least <= MIN_PART * largest {
        return Err(format!("expected at least {terms} different loads"));
    }
    let mut solution = DVector::from_column_slice(forces);
    decomposition.q_tr_mul(&mut solution);
    let solved = triangle.solve_upper_triangular(&solution.rows(0, terms));
    let solution = solved.ok_or("expected loads that determine the coefficients")?;
    Ok(solution.iter().copied().collect())
}
