//! Sequence-number checks of received messages.
//!
//! Duplicates and messages older than the latest are rejected. So are numbers that are implausibly far ahead: accepting
//! one would lock out its sender.

use super::rejection::Rejection;

/// Maximum rate of a message kind from one program (1/s).
const MAX_RATE: f64 = 10_000.0;

/// Maximum gap between sequence numbers that is accepted after any time, since a burst of messages may be lost.
const MAX_AHEAD: f64 = 1000.0;

/// Time without an accepted message (s) after which the next one is accepted with any number. Thus a wrong number does
/// not lock out its sender. Old data is still rejected, because ages are checked separately.
pub const FORGOTTEN_AFTER: f64 = 0.5;

/// Latest accepted message of a kind.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sequence {
    newest: Option<Newest>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Newest {
    instance: u64,
    number: u64,
    /// Time at which the message was accepted (s).
    at: f64,
}

impl Sequence {
    /// Returns the sender's instance and the number of the latest message.
    pub fn newest(&self) -> Option<(u64, u64)> {
        self.newest.map(|newest| (newest.instance, newest.number))
    }

    /// Returns the number of messages missing before message `number` of `instance`, received at `now` (s).
    ///
    /// # Errors
    /// If the message is not newer than the latest, or implausibly far ahead.
    pub fn missing(&self, (instance, number): (u64, u64), now: f64) -> Result<u64, Rejection> {
        let same = |newest: &Newest| newest.instance == instance;
        let Some(newest) = self.newest.filter(same) else {
            return Ok(0);
        };
        let waited = now - newest.at;
        if waited > FORGOTTEN_AFTER {
            return Ok(number
                .saturating_sub(newest.number + 1)
                .min(most_ahead(waited)));
        }
        match number.checked_sub(newest.number) {
            None | Some(0) => Err(Rejection::Old),
            Some(ahead) if ahead > most_ahead(waited) => Err(Rejection::Implausible),
            Some(ahead) => Ok(ahead - 1),
        }
    }

    /// Accepts message `number` of `instance`, received at `now` (s), and returns the number of messages missing before
    /// it.
    ///
    /// # Errors
    /// See [`missing`](Self::missing).
    pub fn accept(&mut self, number: (u64, u64), now: f64) -> Result<u64, Rejection> {
        let missing = self.missing(number, now)?;
        self.take(number, now);
        Ok(missing)
    }

    /// Records message `number` of `instance`, received at `now` (s), as the latest.
    pub fn take(&mut self, (instance, number): (u64, u64), now: f64) {
        self.newest = Some(Newest {
            instance,
            number,
            at: now,
        });
    }
}

/// Returns the maximum accepted gap after `waited` (s).
fn most_ahead(waited: f64) -> u64 {
    (MAX_AHEAD + MAX_RATE * waited.max(0.0)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// State after message 10 of program 1 at 1 s.
    fn after_ten() -> Sequence {
        let mut sequence = Sequence::default();
        sequence.take((1, 10), 1.0);
        sequence
    }

    #[test]
    fn gaps_are_counted_and_duplicates_rejected() {
        let sequence = after_ten();
        assert_eq!(sequence.missing((1, 11), 1.01), Ok(0));
        assert_eq!(sequence.missing((1, 14), 1.01), Ok(3));
        assert_eq!(sequence.missing((1, 10), 1.01), Err(Rejection::Old));
        assert_eq!(sequence.missing((1, 9), 1.01), Err(Rejection::Old));
        assert_eq!(sequence.missing((2, 3), 1.01), Ok(0));
    }

    #[test]
    fn implausible_numbers_are_rejected() {
        let sequence = after_ten();
        for number in [u64::MAX, u64::MAX - 1, 10 + 1101] {
            let taken = sequence.missing((1, number), 1.01);
            assert_eq!(taken, Err(Rejection::Implausible), "{number}");
        }
        assert_eq!(sequence.missing((1, 10 + 1100), 1.01), Ok(1099));
        assert_eq!(sequence.missing((1, 11), 1.01), Ok(0));
    }

    #[test]
    fn a_locked_out_sender_is_readmitted() {
        let sequence = after_ten();
        assert_eq!(sequence.missing((1, 3), 1.5), Err(Rejection::Old));
        assert_eq!(sequence.missing((1, 3), 1.51), Ok(0));
        assert_eq!(sequence.missing((1, u64::MAX), 1.51), Ok(6100));
    }
}
