//! The stops that are in force: the hand stands still until each has been resumed.

use super::message::{NO_ID, StopInForce};
use super::printable::printable;
use feeler::control::stop_reason::StopReason;

/// Stops that are told apart. Of more, the newest stands for all that came after the others.
pub(crate) const MOST: usize = 16;

/// Orders that are remembered after they were resumed: a late copy of one does not stop the hand again.
const REMEMBERED: usize = 64;

/// The stops in force.
#[derive(Debug, Clone, Default)]
pub struct Holds {
    in_force: Vec<Hold>,
    /// Number of the newest stop.
    newest: u64,
    /// Orders that were resumed, by what their senders drew; the oldest is overwritten.
    resumed: Vec<u64>,
    next_resumed: usize,
}

/// A stop that has not been resumed.
#[derive(Debug, Clone, PartialEq)]
pub struct Hold {
    /// Its number.
    pub number: u64,
    /// Who or what stopped the hand.
    pub cause: Cause,
    /// The same in words.
    pub by: String,
}

/// Who or what stopped a hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Somebody, by an order of this id; 0: none was drawn.
    Order(u64),
    /// The hand itself, for want of fresh data.
    Stale,
    /// The hand itself, for another reason.
    Fault,
}

impl Hold {
    /// Whether the hand stopped by itself.
    fn is_own(&self) -> bool {
        !matches!(self.cause, Cause::Order(_))
    }

    /// The same as a message.
    pub fn to_message(&self) -> StopInForce {
        let (number, by) = (self.number, self.by.clone());
        let id = match self.cause {
            Cause::Order(0) => NO_ID,
            Cause::Order(id) => id,
            Cause::Stale | Cause::Fault => 0,
        };
        StopInForce { number, id, by }
    }
}

impl Holds {
    /// The stops in force, the oldest first.
    pub fn in_force(&self) -> &[Hold] {
        &self.in_force
    }

    /// Number of the newest stop, in force or not; 0 before the first.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// Stops the hand by the order `id` (0: none was drawn) of whoever calls himself `from`; the number of the stop.
    /// The same order again is the same stop; none where it has been resumed.
    pub fn order(&mut self, id: u64, from: &str) -> Option<u64> {
        let from = if from.is_empty() { "somebody" } else { from };
        let (cause, by) = (Cause::Order(id), printable(from));
        let same = |hold: &&Hold| hold.cause == cause && (id != 0 || hold.by == by);
        if let Some(hold) = self.in_force.iter().find(same) {
            return Some(hold.number);
        }
        let was_resumed = id != 0 && self.resumed.contains(&id);
        (!was_resumed).then(|| self.add(cause, by))
    }

    /// Says that the hand stopped by itself, and why. It does so once, until that stop has been resumed.
    pub fn fault(&mut self, why: &StopReason) {
        if self.in_force.iter().any(Hold::is_own) {
            return;
        }
        let cause = match why.is_stale() {
            true => Cause::Stale,
            false => Cause::Fault,
        };
        self.add(cause, printable(&why.to_string()));
    }

    /// Resumes the stop of this `number`; whether it was in force.
    pub fn resume(&mut self, number: u64) -> bool {
        let found = self.in_force.iter().position(|hold| hold.number == number);
        let Some(index) = found else {
            return false;
        };
        if let Cause::Order(id @ 1..) = self.in_force.remove(index).cause {
            self.remember(id);
        }
        true
    }

    /// Resumes what the hand stopped for by itself for want of fresh data.
    pub fn resume_stale(&mut self) {
        self.in_force.retain(|hold| hold.cause != Cause::Stale);
    }

    /// Who ordered the oldest stop in force that was ordered.
    pub fn ordered_by(&self) -> Option<&str> {
        let ordered = |hold: &&Hold| !hold.is_own();
        Some(&self.in_force.iter().find(ordered)?.by)
    }

    fn add(&mut self, cause: Cause, by: String) -> u64 {
        self.newest += 1;
        if self.in_force.len() == MOST {
            self.in_force.pop();
        }
        let number = self.newest;
        self.in_force.push(Hold { number, cause, by });
        number
    }

    fn remember(&mut self, id: u64) {
        match self.resumed.get_mut(self.next_resumed) {
            Some(oldest) => *oldest = id,
            None => self.resumed.push(id),
        }
        self.next_resumed = (self.next_resumed + 1) % REMEMBERED;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_of_two_need_two_resumes() {
        let mut holds = Holds::default();
        assert_eq!(holds.order(7, "a"), Some(1));
        assert_eq!(holds.order(8, "b"), Some(2));
        assert_eq!(holds.order(7, "a"), Some(1), "said again");
        assert!(holds.resume(1));
        assert!(!holds.resume(1), "an old number resumes nothing");
        assert_eq!(holds.ordered_by(), Some("b"));
        assert!(holds.resume(2));
        assert!(holds.in_force().is_empty());
    }

    #[test]
    fn a_late_copy_of_a_resumed_order_stops_nothing_and_a_new_order_does() {
        let mut holds = Holds::default();
        holds.order(7, "a");
        holds.resume(1);
        assert_eq!(holds.order(7, "a"), None);
        assert_eq!(holds.order(9, "a"), Some(2));
        // Who draws no number says the same stop again until it is resumed, and then a new one.
        holds.resume(2);
        assert_eq!(holds.order(0, "door"), Some(3));
        assert_eq!(holds.order(0, "door"), Some(3));
        holds.resume(3);
        assert_eq!(holds.order(0, "door"), Some(4));
    }

    #[test]
    fn the_hands_own_stops_are_one_and_apart_from_orders() {
        let mut holds = Holds::default();
        let stale = |age| StopReason::StaleState { age, limit: 0.035 };
        holds.fault(&stale(0.04));
        holds.fault(&stale(0.05));
        holds.order(7, "a");
        assert_eq!(holds.in_force().len(), 2);
        holds.resume_stale();
        assert_eq!(holds.ordered_by(), Some("a"));
        // What does not pass with fresh data waits for somebody.
        let (finger, element) = (0, 3);
        holds.fault(&StopReason::NoForce { finger, element });
        holds.resume_stale();
        assert_eq!(holds.in_force().len(), 2);
    }

    #[test]
    fn of_a_flood_the_newest_holds() {
        let mut holds = Holds::default();
        for id in 1..=100 {
            holds.order(id, "flood");
        }
        assert_eq!(holds.in_force().len(), MOST);
        assert!(!holds.resume(50));
        for number in 1..MOST as u64 {
            assert!(holds.resume(number));
        }
        assert_eq!(holds.in_force().len(), 1);
        assert!(holds.resume(100));
        assert!(holds.in_force().is_empty());
    }
}
