//! Whether a message is the next of its sender's, by the number that it has among them.
//!
//! A message may not be taken twice, nor after a later one. Nor may its number run away: one message with a number
//! that its sender will not reach would shut that sender out.

use super::rejection::Rejection;

/// Messages of a kind that a program sends in a second at most.
const MOST_RATE: f64 = 10_000.0;

/// By how much a number may be ahead at once: messages that were lost in a burst.
const MOST_AHEAD: f64 = 1000.0;

/// After so long without a message that was taken, the next is taken whatever its number, s. It is no door to old
/// data, whose age is proved by other means; it lets a sender back in whose number was overtaken.
pub const FORGOTTEN_AFTER: f64 = 0.5;

/// The newest message of a kind.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sequence {
    newest: Option<Newest>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Newest {
    instance: u64,
    number: u64,
    /// When it was taken, s.
    at: f64,
}

impl Sequence {
    /// The program that sent the newest message, by its instance, and the number of that.
    pub fn newest(&self) -> Option<(u64, u64)> {
        self.newest.map(|newest| (newest.instance, newest.number))
    }

    /// How many messages are missing before that of `number`, which `instance` sent and which came at `now`, s.
    ///
    /// # Errors
    /// When it is not newer than the newest, or too far ahead of it.
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

    /// Takes the message of `number`, which `instance` sent and which came at `now`, s.
    pub fn take(&mut self, (instance, number): (u64, u64), now: f64) {
        self.newest = Some(Newest {
            instance,
            number,
            at: now,
        });
    }
}

/// By how much the number can be ahead after `waited`, s.
fn most_ahead(waited: f64) -> u64 {
    (MOST_AHEAD + MOST_RATE * waited.max(0.0)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After message 10 of program 1, at 1 s.
    fn after_ten() -> Sequence {
        let mut sequence = Sequence::default();
        sequence.take((1, 10), 1.0);
        sequence
    }

    #[test]
    fn what_is_missing_is_counted_and_nothing_is_taken_twice() {
        let sequence = after_ten();
        assert_eq!(sequence.missing((1, 11), 1.01), Ok(0));
        assert_eq!(sequence.missing((1, 14), 1.01), Ok(3));
        assert_eq!(sequence.missing((1, 10), 1.01), Err(Rejection::Old));
        assert_eq!(sequence.missing((1, 9), 1.01), Err(Rejection::Old));
        assert_eq!(sequence.missing((2, 3), 1.01), Ok(0));
    }

    #[test]
    fn a_number_that_runs_away_is_refused_and_the_true_one_taken() {
        let sequence = after_ten();
        for number in [u64::MAX, u64::MAX - 1, 10 + 1101] {
            let taken = sequence.missing((1, number), 1.01);
            assert_eq!(taken, Err(Rejection::Implausible), "{number}");
        }
        assert_eq!(sequence.missing((1, 10 + 1100), 1.01), Ok(1099));
        assert_eq!(sequence.missing((1, 11), 1.01), Ok(0));
    }

    #[test]
    fn a_sender_whose_number_was_overtaken_comes_back() {
        let sequence = after_ten();
        assert_eq!(sequence.missing((1, 3), 1.5), Err(Rejection::Old));
        assert_eq!(sequence.missing((1, 3), 1.51), Ok(0));
        assert_eq!(sequence.missing((1, u64::MAX), 1.51), Ok(6100));
    }
}
