//! When the steps of the hand program begin.

use crate::hand_inbox::HandInbox;
use crate::message::CommandMessage;
use crate::network::Network;
use crate::outlet::{TimeSource, send};
use crate::shared::Shared;
use crate::topic::Topic;
use feeler::pace::{Pace, Schedule, Tick};
use std::sync::Arc;
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
    pub network: Arc<dyn Network>,
    /// What the hand sent last.
    pub command: Shared<Option<CommandMessage>>,
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
    /// Says again what the rig has not heard, if it still is where it was when it was told: the network may have dropped it.
    fn answer_again(&self) {
        let stands = self.inbox.lock().state_sequence() == self.answered;
        if let Some(command) = self.command.lock().as_ref().filter(|_| stands) {
            // A network that fails ends the hand with its next step.
            let _ = send(&*self.network, Topic::Command, command);
        }
    }

    /// Begins late, by more than [`HANGS_AFTER`], where that passes without the rig's next state.
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        let (answered, began) = (self.answered, (self.clock)());
        self.steps += 1;
        self.inbox.lock().answered = Some(answered);
        while !interrupted.load(Ordering::Relaxed) {
            let whole = |inbox: &mut HandInbox| inbox.is_whole_after(answered);
            if self.inbox.wait_for(PATIENCE, whole) {
                self.answered = self.inbox.lock().state_sequence();
                return Some(Tick::on_time(self.steps));
            }
            self.answer_again();
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
