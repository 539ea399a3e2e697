//! Feature statistics as defined by LeRobot.

use serde_json::{Map, Value, json};

/// Quantiles that LeRobot stores, with their keys.
const QUANTILES: [(&str, f64); 5] = [
    ("q01", 0.01),
    ("q10", 0.1),
    ("q50", 0.5),
    ("q90", 0.9),
    ("q99", 0.99),
];

/// Statistics of a feature per component. The components of an array are the entries of its last axis, pooled over the
/// other axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stats {
    /// Shape of each statistic.
    pub shape: Vec<usize>,
    /// Number of frames.
    count: usize,
    /// Minimum, maximum, mean and population standard deviation.
    moments: [Vec<f64>; 4],
    quantiles: [Vec<f64>; QUANTILES.len()],
}

const MOMENTS: [&str; 4] = ["min", "max", "mean", "std"];

impl Stats {
    /// Statistics over `count` frames (at least one), given all values of each component.
    pub fn new(count: usize, components: Vec<Vec<f64>>) -> Self {
        let once = |values: Vec<f64>| values.into_iter().map(|value| (value, 1)).collect();
        Self::of_counted(count, components.into_iter().map(once).collect())
    }

    /// Like [`new`](Self::new), but from a histogram: pairs of value and number of occurrences.
    pub fn of_counted(count: usize, components: Vec<Vec<(f64, u64)>>) -> Self {
        let mut stats = Self {
            shape: vec![components.len()],
            count,
            moments: Default::default(),
            quantiles: Default::default(),
        };
        for mut values in components {
            values.retain(|(_, times)| *times > 0);
            values.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let number = values.iter().map(|(_, times)| times).sum::<u64>();
            let mean_of = |term: &dyn Fn(f64) -> f64| {
                let terms = values
                    .iter()
                    .map(|&(value, times)| times as f64 * term(value));
                terms.sum::<f64>() / number as f64
            };
            let mean = mean_of(&|value| value);
            let std = mean_of(&|value| (value - mean).powi(2)).sqrt();
            let [min, max] = [0.0, 1.0].map(|share| quantile(&values, number, share));
            for (of_all, of_this) in stats.moments.iter_mut().zip([min, max, mean, std]) {
                of_all.push(of_this);
            }
            for (of_all, (_, share)) in stats.quantiles.iter_mut().zip(QUANTILES) {
                of_all.push(quantile(&values, number, share));
            }
        }
        stats
    }

    /// Replicates the single component to all entries of `shape`.
    pub fn repeat_in_shape(&mut self, shape: &[usize]) {
        let size = shape.iter().product();
        for numbers in self.moments.iter_mut().chain(&mut self.quantiles) {
            *numbers = numbers.iter().copied().cycle().take(size).collect();
        }
        self.shape = shape.to_vec();
    }

    /// Merges the statistics of further frames. As in LeRobot, quantiles are averaged over episodes, weighted by their
    /// number of frames.
    pub fn add(&mut self, other: &Self) {
        let (own, others) = (self.count as f64, other.count as f64);
        let share = others / (own + others);
        let [min, max, mean, std] = &mut self.moments;
        for (component, mean) in mean.iter_mut().enumerate() {
            let [other_min, other_max, other_mean, other_std] =
                [0, 1, 2, 3].map(|moment| other.moments[moment][component]);
            min[component] = min[component].min(other_min);
            max[component] = max[component].max(other_max);
            let apart = other_mean - *mean;
            let within = (1.0 - share) * std[component].powi(2) + share * other_std.powi(2);
            let between = share * (1.0 - share) * apart.powi(2);
            std[component] = (within + between).sqrt();
            *mean += share * apart;
        }
        for (own, other) in self.quantiles.iter_mut().zip(&other.quantiles) {
            for (own, other) in own.iter_mut().zip(other) {
                *own += share * (other - *own);
            }
        }
        self.count += other.count;
    }

    /// All statistics except the count, with their keys.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let names = MOMENTS.into_iter().chain(QUANTILES.map(|(name, _)| name));
        let numbers = self.moments.iter().chain(&self.quantiles);
        names.zip(numbers.map(Vec::as_slice))
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Entry of the feature in `stats.json`.
    pub fn json(&self) -> Value {
        let named = self.numbers().map(|(name, numbers)| {
            let nested = nested(&self.shape, numbers);
            (name.to_string(), nested)
        });
        let mut stats: Map<_, _> = named.collect();
        stats.insert("count".into(), json!([self.count]));
        Value::Object(stats)
    }
}

/// Numbers as nested lists of this shape.
fn nested(shape: &[usize], numbers: &[f64]) -> Value {
    match shape {
        [] | [_] => json!(numbers),
        [_, inner @ ..] => {
            let size = inner.iter().product::<usize>().max(1);
            numbers
                .chunks(size)
                .map(|chunk| nested(inner, chunk))
                .collect()
        }
    }
}

/// Quantile at `share` (0 to 1) of a sorted histogram with `number` samples (at least one), linearly interpolated
/// between neighbouring samples.
fn quantile(sorted: &[(f64, u64)], number: u64, share: f64) -> f64 {
    let place = share * number.saturating_sub(1) as f64;
    let below = place.floor();
    let at = |place: f64| {
        let mut after = 0;
        let found = sorted.iter().find(|(_, times)| {
            after += times;
            place < after as f64
        });
        found.map_or(f64::NAN, |(value, _)| *value)
    };
    at(below) + (place - below) * (at(place.ceil()) - at(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_moments_equal_moments_of_the_whole() {
        let values: Vec<f64> = (0..50).map(|i| ((i * i) as f64 * 0.7).sin()).collect();
        let whole = Stats::new(50, vec![values.clone()]);
        let mut parts = Stats::new(13, vec![values[..13].to_vec()]);
        parts.add(&Stats::new(37, vec![values[13..].to_vec()]));
        for ((name, whole), (_, parts)) in whole.numbers().zip(parts.numbers()).take(4) {
            assert!((whole[0] - parts[0]).abs() < 1e-15, "{name}");
        }
        assert_eq!(parts.count(), 50);
    }

    #[test]
    fn statistics_match_known_values() {
        let stats = Stats::new(5, vec![vec![5.0, 3.0, 1.0, 2.0, 4.0]]);
        let expected = json!({
            "min": [1.0], "max": [5.0], "mean": [3.0], "std": [2f64.sqrt()], "count": [5],
            "q01": [1.04], "q10": [1.4], "q50": [3.0], "q90": [4.6], "q99": [4.96],
        });
        assert_eq!(stats.json(), expected);
        let mut counted = Stats::of_counted(2, vec![vec![(4.0, 1), (9.0, 0), (2.0, 3)]]);
        counted.repeat_in_shape(&[3, 1, 1]);
        let expected = json!([[[2.5]], [[2.5]], [[2.5]]]);
        assert_eq!(counted.json()["mean"], expected);
        assert_eq!(counted.json()["max"][2], json!([[4.0]]));
        assert_eq!(counted.json()["q50"][0], json!([[2.0]]));
        let cube = nested(&[2, 1, 2], &[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(cube, json!([[[1.0, 2.0]], [[3.0, 4.0]]]));
    }
}
