//! The latest message of a channel at a given time.

use crate::messages::channels::Stamped;

/// Maximum difference of stamps that count as the same time (s): the resolution of the recording's clock.
pub const SAME_TIME: f64 = 1e-9;

/// Number of messages older than the latest message at `time` (s).
pub(crate) fn count_before_latest<M: Stamped>(messages: &[M], time: f64) -> usize {
    let known = messages
        .iter()
        .take_while(|m| m.stamp() <= time + SAME_TIME);
    known.count().saturating_sub(1)
}

/// Iterates over one channel to find the latest message at increasing times.
#[derive(Debug, Clone)]
pub struct LatestAt<'a, M> {
    messages: &'a [M],
    next: usize,
}

impl<'a, M: Stamped> LatestAt<'a, M> {
    /// Creates an iterator over these messages, which must be in order of time.
    pub fn new(messages: &'a [M]) -> Self {
        Self { messages, next: 0 }
    }

    /// Latest message at `time` (s), or `None` before the first message. `time` must not be less than in the previous
    /// call.
    pub fn at(&mut self, time: f64) -> Option<&'a M> {
        while (self.messages.get(self.next)).is_some_and(|m| m.stamp() <= time + SAME_TIME) {
            self.next += 1;
        }
        self.messages.get(self.next.checked_sub(1)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::channels::Cap;

    #[test]
    fn the_latest_message_is_held_and_there_are_none_before_the_first() {
        let cap = |stamp| Cap {
            stamp,
            ..Cap::default()
        };
        let messages = [cap(0.1), cap(0.2), cap(0.2 + 5e-10)];
        let mut newest = LatestAt::new(&messages);
        assert_eq!(newest.at(0.0), None);
        assert_eq!(newest.at(0.1), Some(&messages[0]));
        assert_eq!(newest.at(0.15), Some(&messages[0]));
        assert_eq!(newest.at(0.2), Some(&messages[2]));
        assert_eq!(newest.at(9.0), Some(&messages[2]));
    }

    #[test]
    fn messages_older_than_the_newest_are_counted() {
        let messages = [0.1, 0.2, 0.3].map(|stamp| Cap {
            stamp,
            ..Cap::default()
        });
        let older = |time| count_before_latest(&messages, time);
        assert_eq!([0.0, 0.1, 0.2, 0.25, 9.0].map(older), [0, 0, 1, 1, 2]);
    }
}
