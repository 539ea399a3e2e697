//! Decides from the received messages whether the hand may start or move.

use crate::inboxes::hand_inbox::HandInbox;
use crate::inboxes::inbox::Inbox;
use crate::inboxes::peers::Peer;
use crate::messages::message::{Heartbeat, ProgramKind};
use crate::messages::mismatch::Mismatch;
use feeler::control::StopReason;

/// Permission to move in a control step.
#[derive(Debug, Clone, PartialEq)]
pub enum Permission {
    /// Move: all data is fresh, and no stop is active.
    Move,
    /// Stand still. `Some` contains the reason of a new stop; `None` means that earlier stops are still active.
    ActiveStop(Option<StopReason>),
}

impl HandInbox {
    /// Returns the stop reason if any data at `now` (s) is older than `limit` (s) or of unknown age.
    pub fn stale(&self, now: f64, limit: f64) -> Option<StopReason> {
        let (state, fingers) = self.ages(now);
        let old = |age: f64| !age.is_finite() || age > limit;
        if old(state) {
            return Some(StopReason::StaleState { age: state, limit });
        }
        let (finger, age) = fingers.enumerate().find(|&(_, age)| old(age))?;
        Some(StopReason::StaleForces { finger, age, limit })
    }

    /// Returns the names of the programs missing at `now` (s).
    pub fn missing(&self, now: f64) -> Vec<String> {
        let rig = self.peers().taken(ProgramKind::World, now).next();
        let rig = rig.is_none().then(|| ProgramKind::World.to_string());
        let is_missing = |finger: &usize| {
            let mut sensors = self.peers().taken(ProgramKind::Sense, now);
            sensors.all(|peer| peer.heartbeat.finger as usize != *finger)
        };
        let fingers = (0..self.fingers().len()).filter(is_missing);
        let fingers = fingers.map(|finger| format!("sense of finger {finger}"));
        rig.into_iter().chain(fingers).collect()
    }

    /// Returns `true` if the hand may start at `now` (s): all programs are present, and no data is older than `limit`
    /// (s).
    pub fn may_begin(&self, now: f64, limit: f64) -> bool {
        self.missing(now).is_empty() && self.stale(now, limit).is_none()
    }

    /// Returns a competing hand program that is present at `now` (s).
    pub fn rival(&self, now: f64) -> Option<&Peer> {
        self.peers().taken(ProgramKind::Hand, now).next()
    }

    /// Returns a mismatch if this hand, which has not started, must yield to another hand at `now` (s): to one that is
    /// already running, or to a waiting one with an instance smaller than `instance`.
    pub fn hand_ahead(&self, now: f64, instance: u64) -> Option<Mismatch> {
        let rival = self.rival(now)?;
        let Heartbeat {
            rate,
            instance: other,
            ..
        } = rival.heartbeat;
        (rate > 0.0 || other < instance).then(|| rival.taken())
    }

    /// Decides whether the hand may move at `now` (s), and records a stop if any data is older than `limit` (s). With
    /// `resumes_automatically`, stops for stale data end once all data is fresh.
    pub fn verdict(&mut self, now: f64, limit: f64, resumes_automatically: bool) -> Permission {
        let stale = self.stale(now, limit);
        match &stale {
            Some(reason) => self.holds.fault(reason),
            None if resumes_automatically => self.holds.resume_stale(),
            None => {}
        }
        let told = || {
            let by = self.holds.ordered_by()?.to_string();
            Some(StopReason::Requested { by })
        };
        match self.holds.in_force().is_empty() {
            true => Permission::Move,
            false => Permission::ActiveStop(told().or(stale)),
        }
    }
}
