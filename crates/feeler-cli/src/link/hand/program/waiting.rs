//! Waiting: for the other programs, and for what they say.

use super::Program;
use crate::CommandError;
use feeler::control::stop_reason::StopReason;
use feeler_link::inbox::Inbox;
use feeler_link::message::ProgramKind;
use feeler_link::mismatch::Mismatch;
use feeler_link::outlet::send;
use feeler_link::remote::waiting_mode;
use feeler_link::topic::Topic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long the hand waits for the answer of a world that waits for it, before it looks whether to stop.
const PATIENCE: Duration = Duration::from_millis(200);

/// How long a world that waits for the hand may take for its next step, s.
const HANGS_AFTER: f64 = 5.0;

impl Program {
    /// The programs that are not there.
    pub fn missing(&self) -> Vec<String> {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let world = inbox.peers().taken(ProgramKind::World, now).next();
        let world = world.is_none().then(|| ProgramKind::World.to_string());
        let fingers = 0..inbox.fingers().len();
        let senses = |finger: &usize| {
            let mut senses = inbox.peers().taken(ProgramKind::Sense, now);
            senses.all(|peer| peer.heartbeat.finger as usize != *finger)
        };
        let fingers = fingers
            .filter(senses)
            .map(|f| format!("sense of finger {f}"));
        world.into_iter().chain(fingers).collect()
    }

    /// Waits until all programs are there and their data fresh, and tells them that it is; whether they are,
    /// and the program was not stopped meanwhile.
    ///
    /// # Errors
    /// When a program does not agree with this one.
    pub fn wait_for_others(&mut self, stop: &AtomicBool) -> Result<bool, CommandError> {
        while !stop.load(Ordering::Relaxed) {
            let mismatches = self.refusals.new_ones(self.inbox.lock().peers());
            if let Some(mismatch) = mismatches.into_iter().next() {
                return Err(mismatch.into());
            }
            if let Some(mismatch) = self.other_hand() {
                return Err(mismatch.into());
            }
            let mode = waiting_mode(&mut self.inbox.lock(), &self.clock, self.instance);
            send(&*self.network, Topic::Mode, &mode)?;
            if self.missing().is_empty() && self.is_fresh() {
                return Ok(true);
            }
            std::thread::sleep(Duration::from_secs_f64(self.period.min(0.01)));
        }
        Ok(false)
    }

    /// A rig has one hand.
    pub(super) fn other_hand(&self) -> Option<Mismatch> {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let other = inbox.peers().taken(ProgramKind::Hand, now).next()?;
        let program = other.name();
        Some(Mismatch::Taken { program })
    }

    fn is_fresh(&self) -> bool {
        let (limit, _) = self.limits();
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let (state, mut fingers) = inbox.ages(now);
        state <= limit && fingers.all(|age| age <= limit)
    }

    /// Age at which data are stale, s of the hand's own clock, and the control period. Where the world waits
    /// for the hand, data never are, and there is no period.
    pub(super) fn limits(&self) -> (f64, Option<f64>) {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let speed = inbox.peers().taken(ProgramKind::World, now).next();
        match speed.map_or(1.0, |world| world.heartbeat.speed) {
            speed if speed > 0.0 => (self.limit / speed, Some(self.period / speed)),
            _ => (f64::INFINITY, None),
        }
    }

    /// Waits for the world's next state and what all fingers felt then. Where that takes too long, something
    /// hangs, and the hand stops. Whether the program was not stopped meanwhile.
    pub fn wait_in_step(&mut self, stop: &AtomicBool) -> bool {
        let answered = self.answered;
        let began = (self.clock)();
        while !stop.load(Ordering::Relaxed) {
            if (self.inbox).wait_for(PATIENCE, |inbox| inbox.is_whole_after(answered)) {
                return true;
            }
            let age = (self.clock)() - began;
            if age > HANGS_AFTER {
                let limit = HANGS_AFTER;
                let controller = self.control_loop.controller_mut();
                controller.stop(StopReason::StaleState { age, limit });
                return true;
            }
        }
        false
    }
}
