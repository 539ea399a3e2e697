//! Upper bound of the age of received data, without synchronized clocks.
//!
//! The hand numbers its control steps. Each message echoes the latest step that its sender had received when it
//! measured the data, and the time since then. The data was measured no earlier than the hand sent that step, plus that
//! time. This bounds its age on the hand's clock, regardless of network delays and of differences between the programs'
//! clocks.
//!
//! Each step has a token that cannot be guessed before the hand sends it, so an echoed token proves that the sender
//! received the step. Data recorded in another run, or with the number of a future step, is therefore rejected.

use std::fmt;
use std::hash::{BuildHasher, RandomState};

/// Number of steps kept: one second at 1 kHz. Echoes of older steps are not accepted.
const REMEMBERED: usize = 1024;

/// Send times of the latest control steps, in seconds on the hand's clock.
#[derive(Clone)]
pub struct SentSteps {
    /// Step and time, indexed by step modulo the length.
    times: Vec<(u64, f64)>,
    newest: u64,
    /// Key of the tokens, which are SipHash values of the step. Each run has a new random key.
    key: RandomState,
}

/// Prints only the latest step, without the key, because tokens must stay secret.
impl fmt::Debug for SentSteps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let newest = self.times[(self.newest % REMEMBERED as u64) as usize];
        f.debug_tuple("SentSteps")
            .field(&newest)
            .finish_non_exhaustive()
    }
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
    /// Records that `step` was sent at `now` (s).
    pub fn sent(&mut self, step: u64, now: f64) {
        self.times[(step % REMEMBERED as u64) as usize] = (step, now);
        self.newest = step;
    }

    /// Returns the latest step sent, or 0 before the first.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// Returns the token of `step`, which is sent to the other programs with it.
    pub fn token(&self, step: u64) -> u64 {
        self.key.hash_one(step)
    }

    /// Returns the earliest time (s, on the hand's clock) at which data was measured, if the measurement was `echo_age`
    /// (s) after its sender had received `echo_step`.
    ///
    /// Returns `None` if the data echoes no step, a step that is too old or has not been sent, or a wrong token.
    pub fn earliest(&self, (echo_step, echo_token): (u64, u64), echo_age: f64) -> Option<f64> {
        let (step, sent) = self.times[(echo_step % REMEMBERED as u64) as usize];
        let heard = step == echo_step && echo_step > 0 && self.token(echo_step) == echo_token;
        let known = heard && echo_age >= 0.0;
        known.then_some(sent + echo_age).filter(|t| t.is_finite())
    }
}

/// Latest step of the hand that a program has received, echoed in the messages it sends.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Echo {
    /// Step number, or 0 before the first.
    pub step: u64,
    /// The hand's token for the step.
    pub token: u64,
    /// Time of arrival on the receiving program's clock (s).
    pub arrived: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earliest_time_follows_from_the_echoed_step() {
        let mut sent = SentSteps::default();
        let echoed = |sent: &SentSteps, step, age| sent.earliest((step, sent.token(step)), age);
        assert_eq!(echoed(&sent, 0, 0.0), None);
        for step in 1..=2000 {
            sent.sent(step, 0.001 * step as f64);
        }
        assert_eq!(echoed(&sent, 1990, 0.004), Some(1.994));
        // Too old, not sent yet, negative age, not finite.
        assert_eq!(echoed(&sent, 2000 - REMEMBERED as u64, 0.0), None);
        assert_eq!(echoed(&sent, 2001, 0.0), None);
        assert_eq!(echoed(&sent, 1990, -1e-9), None);
        assert_eq!(echoed(&sent, 1990, f64::NAN), None);
        assert_eq!(echoed(&sent, 1990, f64::INFINITY), None);
    }

    #[test]
    fn tokens_of_another_run_are_rejected() {
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
