//! Means of trials with confidence intervals.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Number of bootstrap resamples.
const RESAMPLES: usize = 2000;

/// A mean with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Lower end of the interval.
    pub low: f64,
    /// The mean.
    pub mean: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// Returns the lower end, the mean and the upper end. The ends are NaN for a single trial.
    pub fn with_ends(self, trials: usize) -> [f64; 3] {
        match trials {
            1 => [f64::NAN, self.mean, f64::NAN],
            _ => [self.low, self.mean, self.high],
        }
    }
}

/// Mean of `values` with the percentile bootstrap interval. `None` if there are no values.
pub fn bootstrap(values: &[f64]) -> Option<Estimate> {
    bootstrap_of(values, |drawn| {
        drawn.iter().copied().sum::<f64>() / drawn.len() as f64
    })
}

/// Value of `quantity` for `values` with the percentile bootstrap interval. `None` if there are no values or the
/// quantity is not finite. The result is deterministic because the resampling uses a fixed seed.
pub fn bootstrap_of<T>(values: &[T], quantity: impl Fn(&[&T]) -> f64) -> Option<Estimate> {
    bootstrap_each(values, |drawn| [quantity(drawn)]).map(|[estimate]| estimate)
}

/// Like [`bootstrap_of`], for several quantities at once. Resamples in which a quantity is not finite are
/// ignored for its interval.
pub fn bootstrap_each<T, const K: usize>(
    values: &[T],
    quantities: impl Fn(&[&T]) -> [f64; K],
) -> Option<[Estimate; K]> {
    let all: Vec<&T> = values.iter().collect();
    let means = Some(quantities(&all)).filter(|_| !all.is_empty())?;
    if means.iter().any(|mean| !mean.is_finite()) {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(values.len() as u64);
    let mut drawn = all.clone();
    let mut found: [Vec<f64>; K] = std::array::from_fn(|_| Vec::with_capacity(RESAMPLES));
    for _ in 0..RESAMPLES {
        drawn.fill_with(|| all[random.random_range(0..all.len())]);
        let sample = quantities(&drawn);
        let known = found
            .iter_mut()
            .zip(sample)
            .filter(|(_, value)| value.is_finite());
        known.for_each(|(found, value)| found.push(value));
    }
    Some(std::array::from_fn(|k| ends(&mut found[k], means[k])))
}

fn ends(found: &mut [f64], mean: f64) -> Estimate {
    found.sort_by(f64::total_cmp);
    let end = |place: usize| found.get(place).copied().unwrap_or(mean);
    Estimate {
        low: end(found.len() * 25 / 1000),
        mean,
        high: end((found.len() * 975 / 1000).saturating_sub(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_many_values_is_normal() {
        // 0 to 999: the standard error of the mean is 999.5 / sqrt(12) / sqrt(1000) = 9.13, and 1.96 times that is
        // 17.9; 2000 resamples estimate the 2.5 % quantile to about 4 % of that.
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
