//! The last seconds of a quantity.

use std::collections::VecDeque;

/// The last values of a quantity, thinned out: of each interval that which is furthest from 0, so that a
/// short peak is not missed.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    interval: f64,
    length: usize,
    values: VecDeque<f64>,
    /// When the newest value's interval began, s.
    begun: f64,
}

impl Default for History {
    /// Of the last 40 s, the peaks of each 0.2 s.
    fn default() -> Self {
        Self::new(0.2, 200)
    }
}

impl History {
    /// A history of `length` intervals of `interval` seconds.
    pub fn new(interval: f64, length: usize) -> Self {
        Self {
            interval,
            length,
            values: VecDeque::with_capacity(length),
            begun: f64::NEG_INFINITY,
        }
    }

    /// Time between two values, s.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Takes in that the quantity was `value` at `time`, s. What is not a number is left out.
    pub fn push(&mut self, time: f64, value: f64) {
        if value.is_nan() {
            return;
        }
        // Half a part in a thousand, so that the rounding of times moves no value to the next interval.
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

    /// The values, the oldest first.
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
    fn the_oldest_is_forgotten_and_no_number_is_taken_that_is_none() {
        let mut history = History::new(1.0, 2);
        for step in 0..5 {
            history.push(f64::from(step), f64::from(step));
            history.push(f64::from(step), f64::NAN);
        }
        assert_eq!(history.values(), [3.0, 4.0]);
    }
}
