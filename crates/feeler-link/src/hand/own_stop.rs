//! Stop that a rig orders when its drives fail, until it is resumed.

use super::holds::MOST;
use crate::messages::message::{PROTOCOL, StopInForce, StopMessage};
use crate::messages::printable::printable;
use crate::transport::outlet::draw_instance;

/// Stop ordered by the rig itself.
#[derive(Debug, Clone, PartialEq)]
pub struct RigStop {
    id: u64,
    why: String,
    /// Instance of the hand that last reported this stop as active, if any.
    held_by: Option<u64>,
    is_resumed: bool,
}

impl RigStop {
    /// Creates a stop that no hand has received yet.
    pub fn new(why: &str) -> Self {
        Self {
            id: draw_instance(),
            why: printable(&format!("the rig: {why}")),
            held_by: None,
            is_resumed: false,
        }
    }

    /// Processes the active `stops` reported by the instance `hand`. If the same hand reported this stop before and no
    /// longer does, it was resumed, unless the list of stops is full and may have dropped it. A new hand must receive
    /// the order again.
    pub fn hear(&mut self, hand: u64, stops: &[StopInForce]) {
        if stops.iter().any(|stop| stop.id == self.id) {
            self.held_by = Some(hand);
        } else if self.held_by == Some(hand) && stops.len() < MOST {
            self.is_resumed = true;
        } else if self.held_by != Some(hand) {
            self.held_by = None;
        }
    }

    /// Returns the order to send, or `None` once a hand has reported the stop as active.
    pub fn order(&self) -> Option<StopMessage> {
        let (protocol, from, id) = (PROTOCOL, self.why.clone(), self.id);
        let unheard = self.held_by.is_none() && !self.is_resumed;
        unheard.then_some(StopMessage { protocol, from, id })
    }

    /// Returns `true` if the stop was active and has been resumed.
    pub fn is_resumed(&self) -> bool {
        self.is_resumed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_force(ids: impl IntoIterator<Item = u64>) -> Vec<StopInForce> {
        let stop = |id| StopInForce {
            id,
            ..StopInForce::default()
        };
        ids.into_iter().map(stop).collect()
    }

    #[test]
    fn resumed_when_the_same_hand_no_longer_reports_it() {
        let mut own = RigStop::new("servo 3 is silent");
        let order = own.order().expect("an order");
        assert_eq!(order.from, "the rig: servo 3 is silent");
        own.hear(7, &in_force([]));
        assert!(own.order().is_some() && !own.is_resumed(), "not active yet");
        own.hear(7, &in_force([1, own.id]));
        assert!(own.order().is_none() && !own.is_resumed());
        own.hear(7, &in_force([1]));
        assert!(own.order().is_none() && own.is_resumed());
    }

    #[test]
    fn another_hand_receives_the_order_again() {
        let mut own = RigStop::new("servo 3 is silent");
        own.hear(7, &in_force([own.id]));
        own.hear(8, &in_force([]));
        assert!(own.order().is_some() && !own.is_resumed());
        own.hear(8, &in_force([own.id]));
        own.hear(7, &in_force([]));
        assert!(!own.is_resumed(), "hand 7 has been replaced");
    }

    #[test]
    fn dropping_out_of_a_full_list_does_not_resume_it() {
        let mut own = RigStop::new("servo 3 is silent");
        own.hear(7, &in_force([own.id]));
        own.hear(7, &in_force(1..=MOST as u64));
        assert!(!own.is_resumed());
        own.hear(7, &in_force(1..MOST as u64));
        assert!(own.is_resumed(), "the list is no longer full");
    }
}
