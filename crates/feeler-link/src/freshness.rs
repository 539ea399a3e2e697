//! How old data can be at most, without clocks that agree.
//!
//! The hand numbers its control steps, and whoever sends it data says which step was the newest it had
//! heard of, and how long before. The data cannot be older than that step plus that wait: an upper
//! bound of their age on the hand's own clock, whatever the network did on the way, and however the
//! clocks of the programs differ.

/// Steps that are remembered. Older ones prove nothing any more: a second at 1 kHz.
const REMEMBERED: usize = 1024;

/// When the newest control steps were sent, s on the hand's clock.
#[derive(Debug, Clone)]
pub struct SentSteps {
    /// Step and time, by step modulo the length.
    times: Vec<(u64, f64)>,
    newest: u64,
}

impl Default for SentSteps {
    fn default() -> Self {
        Self {
            times: vec![(0, f64::NEG_INFINITY); REMEMBERED],
            newest: 0,
        }
    }
}

impl SentSteps {
    /// Remembers that `step` was sent at `now`, s.
    pub fn sent(&mut self, step: u64, now: f64) {
        self.times[(step % REMEMBERED as u64) as usize] = (step, now);
        self.newest = step;
    }

    /// The newest step that was sent; 0 before the first.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// The earliest time, s on the hand's clock, at which data can have been taken that were taken
    /// `echo_age` (s) after the news of `echo_step` had arrived. Nothing is known of data that echo
    /// nothing, a step that is no longer remembered, or one that has not been sent.
    pub fn earliest(&self, echo_step: u64, echo_age: f64) -> Option<f64> {
        let (step, sent) = self.times[(echo_step % REMEMBERED as u64) as usize];
        let known = step == echo_step && echo_step > 0 && echo_age >= 0.0;
        known.then_some(sent + echo_age).filter(|t| t.is_finite())
    }
}

/// The newest step of the hand that a program has heard of, to be echoed in what it sends.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Echo {
    /// The step; 0 before the first.
    pub step: u64,
    /// When it arrived, s on the program's own clock.
    pub arrived: f64,
}

impl Echo {
    /// Takes in that the hand's `step` arrived at `now`, s.
    pub fn heard(&mut self, step: u64, now: f64) {
        if step > self.step {
            *self = Self { step, arrived: now };
        }
    }

    /// Forgets a hand that is gone; another counts from 1 again.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_are_no_older_than_the_step_they_echo() {
        let mut sent = SentSteps::default();
        assert_eq!(sent.earliest(0, 0.0), None);
        for step in 1..=2000 {
            sent.sent(step, 0.001 * step as f64);
        }
        assert_eq!(sent.earliest(1990, 0.004), Some(1.994));
        // Not remembered, not sent yet, from before its own cause, no number.
        assert_eq!(sent.earliest(2000 - REMEMBERED as u64, 0.0), None);
        assert_eq!(sent.earliest(2001, 0.0), None);
        assert_eq!(sent.earliest(1990, -1e-9), None);
        assert_eq!(sent.earliest(1990, f64::NAN), None);
        assert_eq!(sent.earliest(1990, f64::INFINITY), None);
    }

    #[test]
    fn the_newest_step_is_echoed_whatever_the_order() {
        let mut echo = Echo::default();
        for (step, now) in [(1, 0.1), (3, 0.2), (2, 0.3)] {
            echo.heard(step, now);
        }
        assert_eq!(
            echo,
            Echo {
                step: 3,
                arrived: 0.2
            }
        );
    }
}
