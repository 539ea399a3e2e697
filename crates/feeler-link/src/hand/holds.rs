//! Active stops. The hand does not move until all of them have been resumed.

use crate::messages::message::{NO_ID, StopInForce};
use crate::messages::printable::printable;
use feeler::control::StopReason;

/// Maximum number of active stops. When the list is full, a new stop replaces the newest one.
pub(crate) const MOST: usize = 16;

/// Number of resumed orders kept, so that a late duplicate does not stop the hand again.
const REMEMBERED: usize = 64;

/// List of active stops.
#[derive(Debug, Clone, Default)]
pub struct ActiveStops {
    in_force: Vec<ActiveStop>,
    /// Number of the latest stop.
    newest: u64,
    /// Ids of resumed orders, as a ring buffer.
    resumed: Vec<u64>,
    next_resumed: usize,
}

/// Active stop.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveStop {
    /// Number of the stop.
    pub number: u64,
    /// Cause of the stop.
    pub cause: Cause,
    /// Sender of the order, or the reason if the hand stopped itself.
    pub by: String,
}

/// Cause of a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Order with this id, or 0 if the sender assigned none.
    Order(u64),
    /// Stopped by the hand itself because of stale data.
    Stale,
    /// Stopped by the hand itself for another reason.
    Fault,
}

impl ActiveStop {
    /// Returns `true` if the hand stopped itself.
    fn is_own(&self) -> bool {
        !matches!(self.cause, Cause::Order(_))
    }

    /// Converts the stop to a message.
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

impl ActiveStops {
    /// Returns the active stops, oldest first.
    pub fn in_force(&self) -> &[ActiveStop] {
        &self.in_force
    }

    /// Returns the number of the latest stop, active or not, or 0 before the first.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// Adds a stop for the order `id` (0 if the sender assigned none) from the sender `from`, and returns its number.
    /// For a repeated order, returns the same number, or `None` if that stop has been resumed.
    pub fn order(&mut self, id: u64, from: &str) -> Option<u64> {
        let from = if from.is_empty() { "unknown" } else { from };
        let (cause, by) = (Cause::Order(id), printable(from));
        let same = |hold: &&ActiveStop| hold.cause == cause && (id != 0 || hold.by == by);
        if let Some(hold) = self.in_force.iter().find(same) {
            return Some(hold.number);
        }
        let was_resumed = id != 0 && self.resumed.contains(&id);
        (!was_resumed).then(|| self.add(cause, by))
    }

    /// Adds a stop by the hand itself, unless such a stop is already active.
    pub fn fault(&mut self, why: &StopReason) {
        if self.in_force.iter().any(ActiveStop::is_own) {
            return;
        }
        let cause = match why.is_stale() {
            true => Cause::Stale,
            false => Cause::Fault,
        };
        self.add(cause, printable(&why.to_string()));
    }

    /// Resumes the stop with this number. Returns `false` if it was not active.
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

    /// Resumes the stop for stale data, if active.
    pub fn resume_stale(&mut self) {
        self.in_force.retain(|hold| hold.cause != Cause::Stale);
    }

    /// Returns the sender of the oldest active order.
    pub fn ordered_by(&self) -> Option<&str> {
        let ordered = |hold: &&ActiveStop| !hold.is_own();
        Some(&self.in_force.iter().find(ordered)?.by)
    }

    fn add(&mut self, cause: Cause, by: String) -> u64 {
        self.newest += 1;
        if self.in_force.len() == MOST {
            self.in_force.pop();
        }
        let number = self.newest;
        self.in_force.push(ActiveStop { number, cause, by });
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
    fn each_stop_needs_its_own_resume() {
        let mut holds = ActiveStops::default();
        assert_eq!(holds.order(7, "a"), Some(1));
        assert_eq!(holds.order(8, "b"), Some(2));
        assert_eq!(holds.order(7, "a"), Some(1), "repeated");
        assert!(holds.resume(1));
        assert!(!holds.resume(1), "an old number resumes nothing");
        assert_eq!(holds.ordered_by(), Some("b"));
        assert!(holds.resume(2));
        assert!(holds.in_force().is_empty());
    }

    #[test]
    fn a_late_duplicate_of_a_resumed_order_is_ignored() {
        let mut holds = ActiveStops::default();
        holds.order(7, "a");
        holds.resume(1);
        assert_eq!(holds.order(7, "a"), None);
        assert_eq!(holds.order(9, "a"), Some(2));
        // Orders without an id are one stop until it is resumed.
        holds.resume(2);
        assert_eq!(holds.order(0, "door"), Some(3));
        assert_eq!(holds.order(0, "door"), Some(3));
        holds.resume(3);
        assert_eq!(holds.order(0, "door"), Some(4));
    }

    #[test]
    fn the_hands_own_stop_is_separate_from_orders() {
        let mut holds = ActiveStops::default();
        let stale = |age| StopReason::StaleState { age, limit: 0.035 };
        holds.fault(&stale(0.04));
        holds.fault(&stale(0.05));
        holds.order(7, "a");
        assert_eq!(holds.in_force().len(), 2);
        holds.resume_stale();
        assert_eq!(holds.ordered_by(), Some("a"));
        // Other faults do not end with fresh data.
        let (finger, element) = (0, 3);
        holds.fault(&StopReason::NoForce { finger, element });
        holds.resume_stale();
        assert_eq!(holds.in_force().len(), 2);
    }

    #[test]
    fn a_flood_of_stops_is_bounded() {
        let mut holds = ActiveStops::default();
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
