//! Streaming peak counter for series of any length.

use super::series::count_peaks;
use std::collections::VecDeque;

/// Fraction of the run's maximum that a signal must exceed to start a peak.
pub const PEAK_RISES_ABOVE: f64 = 0.10;
/// Fraction of the run's maximum below which a peak ends.
pub const PEAK_ENDS_BELOW: f64 = 0.05;

/// Counts the peaks that [`count_peaks`] finds in the [`moving_mean`](super::series::moving_mean) of a series. Stores
/// only the turning points that can affect the count, about two per peak.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeakCounter {
    /// Half width of the moving mean's window (samples).
    half: usize,
    /// Latest samples, at most one window.
    newest: VecDeque<f64>,
    /// Number of samples so far.
    taken: usize,
    /// Threshold above which a peak starts, relative to the largest mean; see [`count_peaks`].
    upper: f64,
    /// Threshold below which a peak ends, relative to the largest mean.
    lower: f64,
    /// Largest mean so far.
    largest: f64,
    /// Turning points that can affect the count, alternating between high and low, and the last mean.
    turns: Vec<f64>,
    /// `true` if a mean was not finite.
    spoilt: bool,
}

impl PeakCounter {
    /// Counter for a mean over `window` samples. A peak starts above `upper` times the largest mean and ends below
    /// `lower` times it.
    pub fn new(window: usize, upper: f64, lower: f64) -> Self {
        Self {
            half: window / 2,
            newest: VecDeque::new(),
            taken: 0,
            upper,
            lower,
            largest: f64::NEG_INFINITY,
            turns: Vec::new(),
            spoilt: false,
        }
    }

    /// Adds the next sample.
    pub fn take(&mut self, sample: f64) {
        if self.newest.len() > 2 * self.half {
            self.newest.pop_front();
        }
        self.newest.push_back(sample);
        self.taken += 1;
        if self.taken > self.half {
            // The window around the sample `half` samples ago is complete.
            self.take_mean(0);
        }
    }

    /// Number of peaks; `None` if no mean is positive or a value is not finite.
    pub fn count(mut self) -> Option<usize> {
        let first = self.taken - self.newest.len();
        for middle in self.taken.saturating_sub(self.half)..self.taken {
            let start = middle.saturating_sub(self.half).max(first);
            self.take_mean(start - first);
        }
        match self.spoilt {
            true => None,
            false => count_peaks(&self.turns, self.upper, self.lower),
        }
    }

    /// Adds the mean of the current window without its first `skipped` samples. Sums in the order of `moving_mean`, so that
    /// results are identical.
    fn take_mean(&mut self, skipped: usize) {
        let near = self.newest.iter().skip(skipped);
        let mean = near.sum::<f64>() / (self.newest.len() - skipped) as f64;
        self.spoilt |= !mean.is_finite();
        if !self.spoilt {
            self.largest = self.largest.max(mean);
            while self.forget_a_turn(mean) {}
            self.turns.push(mean);
        }
    }

    /// Removes turning points that cannot affect the count, regardless of the values after `next`. Returns `true` if
    /// any were removed.
    ///
    /// The final maximum M is at least the current one. A high turning point counts only above `upper` M, a low one
    /// only below `lower` M. A low turning point `b` and a later higher one `z` that are [close](Self::are_close)
    /// cannot both count.
    fn forget_a_turn(&mut self, next: f64) -> bool {
        let count = self.turns.len();
        let [.., before, last] = self.turns[..] else {
            return false;
        };
        let falls = next < last;
        let goes_on = (before <= last && !falls) || (before >= last && next <= last);
        // This high turning point is too low for any M.
        let too_low = falls && before < last && last <= self.upper * self.largest;
        if goes_on || too_low {
            self.turns.pop();
            return true;
        }
        if falls && next <= before && self.are_close(before, last) {
            // If `before` ends a peak, a later lower value ends it as well. If `last` starts a peak, either the turning
            // point before `before` starts it too, or `last` alone does.
            self.turns.remove(count - 2);
            if let [.., high, last] = self.turns[..] {
                self.turns.truncate(self.turns.len() - 2);
                self.turns.push(high.max(last));
            }
            return true;
        }
        if let ([.., low, high, last], false) = (&self.turns[..], falls) {
            // If `high` starts a peak, `last` is too high to end it; otherwise `low` has already ended it.
            if low < last && last < high && self.are_close(*low, *high) {
                self.turns.pop();
                return true;
            }
        }
        false
    }

    /// `true` if there is no M for which the low turning point ends a peak and the later high one starts another, with
    /// a margin for rounding.
    fn are_close(&self, low: f64, high: f64) -> bool {
        1.001 * self.lower * high <= self.upper * low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::series::moving_mean;
    use proptest::prelude::*;

    fn counter(series: &[f64], window: usize) -> PeakCounter {
        let mut counter = PeakCounter::new(window, 0.10, 0.05);
        series.iter().for_each(|&sample| counter.take(sample));
        counter
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Noisy levels over four powers of ten, so that earlier peaks vanish relative to later ones.
        #[test]
        fn count_equals_that_of_the_whole_series(
            levels in prop::collection::vec((-3.5..0.5f64, 1..6usize, 0.0..0.6f64), 0..60),
            sign in prop::bool::weighted(0.9),
            window in prop::sample::select(vec![1, 3, 5, 51]),
        ) {
            let levels = levels.iter().enumerate();
            let series: Vec<f64> = levels.flat_map(|(k, &(level, length, noise))| {
                let sign = if sign || k % 3 > 0 { 1.0 } else { -1.0 };
                (0..length).map(move |i| {
                    let wave = f64::from((7 * i as u32 + 3 * k as u32) % 5) / 5.0 - 0.4;
                    sign * 10_f64.powf(level) * (1.0 + noise * wave)
                })
            }).collect();
            let expected = count_peaks(&moving_mean(&series, window), 0.10, 0.05);
            prop_assert_eq!(counter(&series, window).count(), expected);
        }
    }

    #[test]
    fn memory_grows_with_peaks_not_samples() {
        let stroke = |i: i32| (f64::from(i) * 0.01).sin().max(0.0);
        let noisy = |i: i32| stroke(i) + 0.03 * f64::from(i * 7919 % 13 - 6) / 6.0;
        let series: Vec<_> = (0..200_000).map(noisy).collect();
        let counter = counter(&series, 5);
        let peaks = count_peaks(&moving_mean(&series, 5), 0.10, 0.05);
        assert!(counter.turns.len() < 3 * peaks.unwrap_or(0), "{peaks:?}");
        assert_eq!(counter.count(), peaks);
    }

    #[test]
    fn non_finite_values_invalidate_the_count() {
        assert_eq!(counter(&[1.0, f64::NAN, 1.0], 3).count(), None);
        assert_eq!(counter(&[], 3).count(), None);
    }
}
