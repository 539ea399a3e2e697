//! When the steps of the hand program begin.

use crate::hand_inbox::HandInbox;
use crate::outlet::TimeSource;
use crate::shared::Shared;
use feeler::pace::{Pace, Schedule, Tick};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long to wait for the rig's next state before looking whether to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// How long a rig that waits for the hand may take for its next step, s: far longer than one that renders pictures on a
/// busy computer.
pub(super) const HANGS_AFTER: f64 = 20.0;

/// When a control step begins.
pub(super) enum HandSchedule {
    /// Once a period.
    Paced(Pace),
    /// When the rig, which waits for the hand, has published its next state and all fingers what they felt then.
    Lockstep(Lockstep),
}

pub(super) struct Lockstep {
    pub inbox: Shared<HandInbox>,
    pub clock: TimeSource,
    /// Number of the state that the newest step was made from.
    pub answered: u64,
    pub steps: u64,
}

impl Schedule for HandSchedule {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        match self {
            Self::Paced(pace) => pace.wait_unless(interrupted),
            Self::Lockstep(lockstep) => lockstep.next_tick(interrupted),
        }
    }
}

impl Lockstep {
    /// Begins late, by more than [`HANGS_AFTER`], where that passes without the rig's next state.
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        let (answered, began) = (self.answered, (self.clock)());
        self.steps += 1;
        while !interrupted.load(Ordering::Relaxed) {
            let whole = |inbox: &mut HandInbox| inbox.is_whole_after(answered);
            if self.inbox.wait_for(PATIENCE, whole) {
                self.answered = self.inbox.lock().state_sequence();
                return Some(Tick::on_time(self.steps));
            }
            let lateness = (self.clock)() - began;
            if lateness > HANGS_AFTER {
                return Some(Tick {
                    lateness,
                    ..Tick::on_time(self.steps)
                });
            }
        }
        None
    }
}
