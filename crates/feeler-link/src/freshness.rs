//! How old data can be at most, without clocks that agree.
//!
//! The hand numbers its control steps, and whoever sends it data says which step was the newest it had
//! heard of, and how long before. The data cannot be older than that step plus that wait: an upper
//! bound of their age on the hand's own clock, whatever the network did on the way, and however the
//! clocks of the programs differ.
//!
//! Each step has a token that nobody can guess before the hand has sent it. Who echoes the token has heard of the
//! step: data that were recorded from another run of a hand, or that claim to come after a step that is yet to come,
//! prove nothing.

use std::hash::{BuildHasher, RandomState};

/// Steps that are remembered. Older ones prove nothing any more: a second at 1 kHz.
const REMEMBERED: usize = 1024;

/// When the newest control steps were sent, s on the hand's clock.
#[derive(Debug, Clone)]
pub struct SentSteps {
    /// Step and time, by step modulo the length.
    times: Vec<(u64, f64)>,
    newest: u64,
    /// Tokens are a keyed hash (SipHash) of the step, by a key that the system draws for each run.
    key: RandomState,
}

impl Default for SentSteps {
    fn default() -> Self {
        Self {
            times: vec![(0, f64::NEG_INFINITY); REMEMBERED],
            newest: 0,
            key: RandomState::new(),
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

    /// The token of `step`, which others learn when it is sent.
    pub fn token(&self, step: u64) -> u64 {
        self.key.hash_one(step)
    }

    /// The earliest time, s on the hand's clock, at which data can have been taken that were taken
    /// `echo_age` (s) after the news of `echo_step` had arrived. Nothing is known of data that echo
    /// nothing, a step that is no longer remembered or has not been sent, or a token that is not its own.
    pub fn earliest(&self, (echo_step, echo_token): (u64, u64), echo_age: f64) -> Option<f64> {
        let (step, sent) = self.times[(echo_step % REMEMBERED as u64) as usize];
        let heard = step == echo_step && echo_step > 0 && self.token(echo_step) == echo_token;
        let known = heard && echo_age >= 0.0;
        known.then_some(sent + echo_age).filter(|t| t.is_finite())
    }
}

/// The newest step of the hand that a program has heard of, to be echoed in what it sends.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Echo {
    /// The step; 0 before the first.
    pub step: u64,
    /// The hand's token of that step.
    pub token: u64,
    /// When it arrived, s on the program's own clock.
    pub arrived: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_are_no_older_than_the_step_they_echo() {
        let mut sent = SentSteps::default();
        let echoed = |sent: &SentSteps, step, age| sent.earliest((step, sent.token(step)), age);
        assert_eq!(echoed(&sent, 0, 0.0), None);
        for step in 1..=2000 {
            sent.sent(step, 0.001 * step as f64);
        }
        assert_eq!(echoed(&sent, 1990, 0.004), Some(1.994));
        // Not remembered, not sent yet, from before its own cause, no number.
        assert_eq!(echoed(&sent, 2000 - REMEMBERED as u64, 0.0), None);
        assert_eq!(echoed(&sent, 2001, 0.0), None);
        assert_eq!(echoed(&sent, 1990, -1e-9), None);
        assert_eq!(echoed(&sent, 1990, f64::NAN), None);
        assert_eq!(echoed(&sent, 1990, f64::INFINITY), None);
    }

    #[test]
    fn another_runs_token_proves_nothing() {
        let (mut this, mut other) = (SentSteps::default(), SentSteps::default());
        for step in 1..=10 {
            this.sent(step, 0.01 * step as f64);
            other.sent(step, 0.01 * step as f64);
        }
        assert_eq!(this.earliest((7, other.token(7)), 0.0), None);
        assert_eq!(this.earliest((7, this.token(6)), 0.0), None);
        assert_eq!(this.earliest((7, this.token(7)), 0.0), Some(0.07));
    }
}
