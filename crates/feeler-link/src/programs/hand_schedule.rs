//! Schedule of the hand program's control steps.

use crate::inboxes::hand_inbox::HandInbox;
use crate::messages::message::CommandMessage;
use crate::transport::network::Network;
use crate::transport::outlet::{TimeSource, send};
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use feeler::pace::{FixedRate, Schedule, Tick};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time to wait for the rig's next state before the interrupt flag is checked and the command resent.
const PATIENCE: Duration = Duration::from_millis(200);

/// Maximum time to wait for the next state of a rig in lockstep (s). Rendering images on a loaded computer takes far
/// less.
pub(super) const HANGS_AFTER: f64 = 20.0;

/// Schedule of control steps.
pub(super) enum HandSchedule {
    /// Fixed control period.
    Paced(FixedRate),
    /// A step starts when the rig's next state and the matching updates of all fingers have arrived.
    Lockstep(Lockstep),
}

pub(super) struct Lockstep {
    pub inbox: Shared<HandInbox>,
    pub clock: TimeSource,
    pub network: Arc<dyn Network>,
    /// Last command sent.
    pub command: Shared<Option<CommandMessage>>,
    /// Sequence number of the state that the latest step is based on.
    pub answered: u64,
    pub steps: u64,
}

impl Schedule for HandSchedule {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        match self {
            Self::Paced(pace) => pace.wait_interruptible(interrupted),
            Self::Lockstep(lockstep) => lockstep.next_tick(interrupted),
        }
    }
}

impl Lockstep {
    /// Resends the last command if the rig has not advanced, because the network may have dropped the command.
    fn answer_again(&self) {
        let stands = self.inbox.lock().state_sequence() == self.answered;
        if let Some(command) = self.command.lock().as_ref().filter(|_| stands) {
            // A failed network ends the program in its next step.
            let _ = send(&*self.network, Topic::Command, command);
        }
    }

    /// Waits for the rig's next state. After [`HANGS_AFTER`] without one, returns a late tick.
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
