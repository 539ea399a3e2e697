//! Linear least squares with up to three coefficients.

use glam::{DMat3, DVec3};

/// Greatest standard deviation of the first coefficient, relative to it, of a stretch that shows it at all.
const EXCITED: f64 = 0.2;

/// Samples of one stretch of a run: rows of up to three regressors, and the value that they explain but for a constant of the
/// stretch.
#[derive(Debug, Clone, Default)]
pub struct Stretch {
    rows: Vec<(DVec3, f64)>,
}

impl Stretch {
    /// Adds a sample.
    pub fn add(&mut self, row: DVec3, value: f64) {
        self.rows.push((row, value));
    }

    fn len(&self) -> usize {
        self.rows.len()
    }

    /// The samples about their mean.
    fn centred(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let count = self.rows.len().max(1) as f64;
        let sum = self.rows.iter().fold((DVec3::ZERO, 0.0), |sum, sample| {
            (sum.0 + sample.0, sum.1 + sample.1)
        });
        let mean = (sum.0 / count, sum.1 / count);
        self.rows
            .iter()
            .map(move |(row, value)| (*row - mean.0, value - mean.1))
    }
}

/// Coefficients of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The coefficients.
    pub coefficients: DVec3,
    /// Their standard deviations if the residuals are independent.
    pub deviations: DVec3,
    /// Standard deviation of the residuals.
    pub residual: f64,
}

impl Fit {
    /// Fits those of `stretches` together that fit alone: whose residual is at most twice that of the best one. An element that
    /// slips stands out.
    pub fn of_consistent(stretches: Vec<Stretch>, used: usize) -> Option<(Self, Vec<Stretch>)> {
        let alone = stretches.into_iter().filter_map(|stretch| {
            let fit = Self::of(std::slice::from_ref(&stretch), used)?;
            let is_excited = fit.deviations.x <= EXCITED * fit.coefficients.x.abs();
            is_excited.then_some((fit.residual, stretch))
        });
        let alone: Vec<_> = alone.collect();
        let least = alone
            .iter()
            .map(|(residual, _)| *residual)
            .fold(f64::INFINITY, f64::min);
        let kept = alone
            .into_iter()
            .filter(|(residual, _)| *residual <= 2.0 * least);
        let kept: Vec<_> = kept.map(|(_, stretch)| stretch).collect();
        Some((Self::of(&kept, used)?, kept))
    }

    /// Fits all `stretches` together, with the first `used` regressors; `None` if they do not determine the coefficients.
    pub fn of(stretches: &[Stretch], used: usize) -> Option<Self> {
        let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
        let (mut squares, mut count) = (0.0, 0.0);
        for stretch in stretches.iter().filter(|stretch| stretch.len() > 1) {
            for (row, value) in stretch.centred() {
                normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
                right += row * value;
                squares += value * value;
            }
            count += stretch.len() as f64 - 1.0;
        }
        for unused in used..3 {
            for other in 0..3 {
                normal.col_mut(other)[unused] = 0.0;
                normal.col_mut(unused)[other] = 0.0;
            }
            normal.col_mut(unused)[unused] = 1.0;
            right[unused] = 0.0;
        }
        let freedom = count - used as f64;
        let scale = normal.x_axis.x * normal.y_axis.y * normal.z_axis.z;
        // Relative to regressors that are independent of each other.
        if !(freedom > 0.0 && normal.determinant() > 1e-9 * scale && scale > 0.0) {
            return None;
        }
        let inverse = normal.inverse();
        let coefficients = inverse * right;
        let variance = (squares - coefficients.dot(right)).max(0.0) / freedom;
        let diagonal = DVec3::new(inverse.x_axis.x, inverse.y_axis.y, inverse.z_axis.z);
        Some(Self {
            coefficients,
            deviations: (variance * diagonal).max(DVec3::ZERO).map(f64::sqrt),
            residual: variance.sqrt(),
        })
    }
}
