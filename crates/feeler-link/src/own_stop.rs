//! The stop that a rig orders when its drives fail: who has it in force, and whether somebody has resumed it.

use super::holds::MOST;
use super::message::{PROTOCOL, StopInForce, StopMessage};
use super::outlet::draw_instance;
use super::printable::printable;

/// A rig's own stop, in force from its first word until somebody has resumed it.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnStop {
    id: u64,
    why: String,
    /// The hand that said last that the stop is in force.
    held_by: Option<u64>,
    is_resumed: bool,
}

impl OwnStop {
    /// A stop that no hand has heard of.
    pub fn new(why: &str) -> Self {
        Self {
            id: draw_instance(),
            why: printable(&format!("the rig: {why}")),
            held_by: None,
            is_resumed: false,
        }
    }

    /// Takes in that `hand`, by its instance, says that `stops` are in force. A stop that it had in force and that is gone was
    /// resumed, unless there are so many that another stands for it. Another hand knows nothing of it yet.
    pub fn hear(&mut self, hand: u64, stops: &[StopInForce]) {
        if stops.iter().any(|stop| stop.id == self.id) {
            self.held_by = Some(hand);
        } else if self.held_by == Some(hand) && stops.len() < MOST {
            self.is_resumed = true;
        } else if self.held_by != Some(hand) {
            self.held_by = None;
        }
    }

    /// The order, to be said until a hand has it in force; none once it has.
    pub fn order(&self) -> Option<StopMessage> {
        let (protocol, from, id) = (PROTOCOL, self.why.clone(), self.id);
        let unheard = self.held_by.is_none() && !self.is_resumed;
        unheard.then_some(StopMessage { protocol, from, id })
    }

    /// Whether a hand had it in force and somebody resumed it.
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
    fn it_is_resumed_when_the_hand_that_had_it_has_it_no_more() {
        let mut own = OwnStop::new("servo 3 is silent");
        let order = own.order().expect("an order");
        assert_eq!(order.from, "the rig: servo 3 is silent");
        own.hear(7, &in_force([]));
        assert!(own.order().is_some() && !own.is_resumed(), "not heard yet");
        own.hear(7, &in_force([1, own.id]));
        assert!(own.order().is_none() && !own.is_resumed());
        own.hear(7, &in_force([1]));
        assert!(own.order().is_none() && own.is_resumed());
    }

    #[test]
    fn another_hand_is_told_and_resumes_nothing_by_knowing_nothing() {
        let mut own = OwnStop::new("servo 3 is silent");
        own.hear(7, &in_force([own.id]));
        own.hear(8, &in_force([]));
        assert!(own.order().is_some() && !own.is_resumed());
        own.hear(8, &in_force([own.id]));
        own.hear(7, &in_force([]));
        assert!(!own.is_resumed(), "hand 7 had been told to, long ago");
    }

    #[test]
    fn a_flood_of_stops_that_drives_it_out_does_not_resume_it() {
        let mut own = OwnStop::new("servo 3 is silent");
        own.hear(7, &in_force([own.id]));
        own.hear(7, &in_force(1..=MOST as u64));
        assert!(!own.is_resumed());
        own.hear(7, &in_force(1..MOST as u64));
        assert!(own.is_resumed(), "what stood for it was resumed");
    }
}
