//! Means of trials, each with an interval that says how well it is known.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Samples that are drawn again from what was measured.
const RESAMPLES: usize = 2000;

/// A mean with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Lower end.
    pub low: f64,
    /// The mean itself.
    pub mean: f64,
    /// Upper end.
    pub high: f64,
}

/// The mean of `values`, with the percentile bootstrap's interval; none of no values. The same for the same
/// values, as its draws have a seed of their own.
pub fn bootstrap(values: &[f64]) -> Option<Estimate> {
    let count = values.len();
    let mean = |sum: f64| sum / count as f64;
    if count == 0 || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(count as u64);
    let mut draw = || values[random.random_range(0..count)];
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| mean((0..count).map(|_| draw()).sum()))
        .collect();
    means.sort_by(f64::total_cmp);
    Some(Estimate {
        low: means[RESAMPLES * 25 / 1000],
        mean: mean(values.iter().sum()),
        high: means[RESAMPLES * 975 / 1000 - 1],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_that_of_the_normal_distribution_where_there_are_many() {
        // 0 to 999: standard error of the mean is 999.5 / sqrt(12) / sqrt(1000) = 9.13 (1.96 of them: 17.9);
        // 2000 resamples know a 2.5 % quantile to some 4 % of that.
        let values: Vec<f64> = (0..1000).map(f64::from).collect();
        let estimate = bootstrap(&values).unwrap();
        assert_eq!(estimate.mean, 499.5);
        assert!(
            (estimate.mean - estimate.low - 17.9).abs() < 2.0,
            "{estimate:?}"
        );
        assert!(
            (estimate.high - estimate.mean - 17.9).abs() < 2.0,
            "{estimate:?}"
        );
        assert_eq!(bootstrap(&[]), None);
        assert_eq!(bootstrap(&[1.0, f64::NAN]), None);
    }
}
