//! Recent history of a quantity.

use std::collections::VecDeque;

/// Recent values of a quantity, decimated: each interval keeps the value of largest magnitude, so that short peaks
/// remain visible.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    interval: f64,
    length: usize,
    values: VecDeque<f64>,
    /// Start of the interval of the latest value (s).
    begun: f64,
}

impl Default for History {
    /// Creates a history with the peak of each 0.2 s over the last 40 s.
    fn default() -> Self {
        Self::new(0.2, 200)
    }
}

impl History {
    /// Creates a history of `length` intervals of `interval` (s).
    pub fn new(interval: f64, length: usize) -> Self {
        Self {
            interval,
            length,
            values: VecDeque::with_capacity(length),
            begun: f64::NEG_INFINITY,
        }
    }

    /// Returns the time between two values (s).
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Adds `value` at `time` (s). NaN is ignored.
    pub fn push(&mut self, time: f64, value: f64) {
        if value.is_nan() {
            return;
        }
        // Tolerance of 0.05 %, so that rounding of times does not move a value to the next interval.
        if time - self.begun >= self.interval * 0.9995 {
            if self.values.len() >= self.length {
                self.values.pop_front();
            }
            self.values.push_back(value);
            self.begun = time;
        } else if let Some(newest) = self.values.back_mut()
            && value.abs() > newest.abs()
        {
            *newest = value;
        }
    }

    /// Returns the values, oldest first.
    pub fn values(&self) -> Vec<f64> {
        self.values.iter().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_peak_is_kept() {
        let mut history = History::new(0.05, 3);
        for step in 0..10 {
            let value = if step == 7 { -9.0 } else { f64::from(step) };
            history.push(0.01 * f64::from(step), value);
        }
        assert_eq!(history.values(), [4.0, -9.0]);
    }

    #[test]
    fn drops_the_oldest_value_and_ignores_nan() {
        let mut history = History::new(1.0, 2);
        for step in 0..5 {
            history.push(f64::from(step), f64::from(step));
            history.push(f64::from(step), f64::NAN);
        }
        assert_eq!(history.values(), [3.0, 4.0]);
    }
}
