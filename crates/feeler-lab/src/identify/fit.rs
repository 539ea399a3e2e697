//! Linear least squares with up to three coefficients.

use glam::{DMat3, DVec3};

/// Maximum relative standard deviation of the first coefficient of a stretch. Stretches above it are not used.
const EXCITED: f64 = 0.2;

/// Samples of a section of a run: rows of up to three regressors and the dependent value, which has an unknown
/// constant offset in each stretch.
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

    /// Samples relative to their mean.
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

/// Result of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The coefficients.
    pub coefficients: DVec3,
    /// Standard deviations of the coefficients, for independent residuals.
    pub deviations: DVec3,
    /// Standard deviation of the residuals.
    pub residual: f64,
}

impl Fit {
    /// Jointly fits those `stretches` whose separate fits have a residual of at most twice the smallest one, which excludes
    /// elements that slip. Also returns the stretches used.
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

    /// Fits all `stretches` together with the first `used` regressors. Returns `None` if they do not determine the
    /// coefficients.
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
        // The determinant is compared with its value for uncorrelated regressors.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of `y = 3 a - 2 b + 0.5 c + constant` with uncorrelated regressors.
    fn stretch(constant: f64) -> Stretch {
        let mut stretch = Stretch::default();
        for index in 0..40 {
            let t = f64::from(index);
            let row = DVec3::new(t, (0.7 * t).sin(), (t % 3.0) - 1.0);
            stretch.add(row, row.dot(DVec3::new(3.0, -2.0, 0.5)) + constant);
        }
        stretch
    }

    #[test]
    fn exact_samples_give_exact_coefficients_for_any_constant() {
        let fit = Fit::of(&[stretch(1.0), stretch(-7.0)], 3).expect("a fit");
        let expected = DVec3::new(3.0, -2.0, 0.5);
        assert!((fit.coefficients - expected).length() < 1e-9, "{fit:?}");
        assert!(fit.residual < 1e-5, "{fit:?}");
    }

    #[test]
    fn constant_regressors_are_rejected() {
        let mut flat = Stretch::default();
        for index in 0..10 {
            flat.add(DVec3::X, f64::from(index));
        }
        assert_eq!(Fit::of(&[flat], 1), None);
        assert_eq!(Fit::of(&[], 3), None);
    }

    #[test]
    fn an_inconsistent_stretch_is_excluded() {
        let mut slipped = stretch(0.0);
        for (_, value) in &mut slipped.rows[20..] {
            *value -= 30.0;
        }
        let mut noisy = stretch(2.0);
        for (index, (_, value)) in noisy.rows.iter_mut().enumerate() {
            *value += if index % 2 == 0 { 0.01 } else { -0.01 };
        }
        let (fit, kept) = Fit::of_consistent(vec![noisy, slipped], 3).expect("a fit");
        assert_eq!(kept.len(), 1);
        assert!((fit.coefficients.x - 3.0).abs() < 1e-3, "{fit:?}");
    }
}
