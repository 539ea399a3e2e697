//! Functions on series of equally spaced samples. They never panic; undefined results (too few samples, no variation, a
//! non-finite value) are `None`.

/// The value, or `None` if it is not finite.
pub fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Arithmetic mean.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = (values.into_iter()).fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
    if count == 0 {
        return None;
    }
    finite(sum / count as f64)
}

/// Root mean square.
pub fn rms(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    mean(values.into_iter().map(|v| v * v)).map(f64::sqrt)
}

/// Population standard deviation.
pub fn standard_deviation(values: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let middle = mean(values.clone())?;
    rms(values.map(|value| value - middle))
}

/// Largest value; `None` if the series is empty or a value is not finite.
pub fn maximum(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    // A full fold is faster on nested series than an early exit. A non-finite value times zero is NaN.
    let start = (f64::NEG_INFINITY, 0.0);
    let (largest, zero) = values.into_iter().fold(start, |(largest, zero), value| {
        let largest = if value > largest { value } else { largest };
        (largest, zero + 0.0 * value)
    });
    finite(largest).filter(|_| zero == 0.0)
}

/// Percentile `p` (0 to 100), linearly interpolated between samples.
pub fn percentile(values: impl IntoIterator<Item = f64>, p: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().map(finite).collect::<Option<_>>()?;
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let place = (p / 100.0).clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    let share = place - below as f64;
    Some(sorted[below] * (1.0 - share) + sorted[above] * share)
}

/// Centred moving mean over `window` samples (even numbers are rounded up to odd); the window is truncated at the
/// ends.
pub fn moving_mean(values: &[f64], window: usize) -> Vec<f64> {
    let half = window / 2;
    (0..values.len())
        .map(|i| {
            let near = &values[i.saturating_sub(half)..values.len().min(i + half + 1)];
            near.iter().sum::<f64>() / near.len() as f64
        })
        .collect()
}

/// Absolute rate of change between consecutive samples, assigned to the later one: one value fewer than `values`. The
/// flag analyzer computes the shear rate in the same way.
pub fn absolute_rate(values: &[f64], period: f64) -> Vec<f64> {
    let pairs = values.windows(2);
    pairs
        .map(|pair| (pair[1] - pair[0]).abs() / period)
        .collect()
}

/// Pearson correlation coefficient; `None` for fewer than three pairs or if one variable is constant.
pub fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    if pairs.len() < 3 {
        return None;
    }
    let mean_x = mean(pairs.iter().map(|p| p.0))?;
    let mean_y = mean(pairs.iter().map(|p| p.1))?;
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        let (x, y) = (x - mean_x, y - mean_y);
        xx += x * x;
        yy += y * y;
        xy += x * y;
    }
    if xx <= 0.0 || yy <= 0.0 {
        return None;
    }
    finite(xy / (xx.sqrt() * yy.sqrt()))
}

/// Number of peaks. A peak starts above `upper` times the largest value and ends below `lower` times the largest value.
/// `None` if no value is positive.
pub fn count_peaks(values: &[f64], upper: f64, lower: f64) -> Option<usize> {
    let peak = maximum(values.iter().copied()).filter(|peak| *peak > 0.0)?;
    let (mut inside, mut count) = (false, 0);
    for &value in values {
        if !inside && value > upper * peak {
            inside = true;
            count += 1;
        } else if inside && value < lower * peak {
            inside = false;
        }
    }
    Some(count)
}

/// Streaming counter of consecutive samples that meet a condition.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stretch {
    current: usize,
    longest: usize,
}

impl Stretch {
    /// Adds the next sample; `met` is `true` if it meets the condition.
    pub fn take(&mut self, met: bool) {
        self.current = if met { self.current + 1 } else { 0 };
        self.longest = self.longest.max(self.current);
    }

    /// Length of the longest stretch so far (samples).
    pub fn longest(&self) -> usize {
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_extremes_of_known_series() {
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(rms([3.0, 4.0, 0.0, 0.0]), Some(2.5));
        assert_eq!(maximum([-3.0, -1.0, -2.0]), Some(-1.0));
        assert_eq!(percentile((0..=100).map(f64::from), 99.0), Some(99.0));
        assert_eq!(percentile([0.0, 10.0], 75.0), Some(7.5));
    }

    #[test]
    fn undefined_results_are_none() {
        assert_eq!(mean([]), None);
        assert_eq!(mean([1.0, f64::NAN]), None);
        assert_eq!(maximum([1.0, f64::INFINITY]), None);
        assert_eq!(percentile([], 50.0), None);
        assert_eq!(percentile([f64::NAN], 50.0), None);
        assert_eq!(correlation(&[(1.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(correlation(&[(1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]), None);
        assert_eq!(count_peaks(&[0.0, -1.0], 0.3, 0.1), None);
        assert_eq!(count_peaks(&[], 0.3, 0.1), None);
    }

    #[test]
    fn correlation_of_lines_is_plus_or_minus_one() {
        let up: Vec<_> = (0..10)
            .map(|i| (f64::from(i), 2.0 * f64::from(i) + 1.0))
            .collect();
        let down: Vec<_> = up.iter().map(|(x, y)| (*x, -y)).collect();
        assert!((correlation(&up).unwrap() - 1.0).abs() < 1e-12);
        assert!((correlation(&down).unwrap() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn dent_does_not_split_a_peak() {
        let peaks = [0.0, 1.0, 0.5, 1.0, 0.0, 0.9, 0.05, 0.2, 0.0];
        assert_eq!(count_peaks(&peaks, 0.3, 0.15), Some(2));
    }

    #[test]
    fn smoothing_keeps_a_line_and_rates_are_absolute() {
        let line: Vec<f64> = (0..9).map(f64::from).collect();
        assert_eq!(moving_mean(&line, 3)[1..8], line[1..8]);
        assert_eq!(absolute_rate(&[0.0, 1.0, -1.0], 0.5), [2.0, 4.0]);
        let mut stretch = Stretch::default();
        for met in [true, false, true, true, false] {
            stretch.take(met);
        }
        assert_eq!(stretch.longest(), 2);
    }
}
