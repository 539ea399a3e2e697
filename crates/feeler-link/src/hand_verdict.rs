//! What follows for the hand from what has arrived: whether it may begin, and move.

use super::hand_inbox::HandInbox;
use super::inbox::Inbox;
use super::message::{Heartbeat, ProgramKind};
use super::mismatch::Mismatch;
use super::peers::Peer;
use feeler::control::stop_reason::StopReason;

/// What a hand may do in a control step.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Move: data are fresh, and no stop is in force.
    Go,
    /// Stand still, for this reason if it is a new one; else for those that are in force.
    Stand(Option<StopReason>),
}

impl HandInbox {
    /// Why the hand must stop at `now` (s): for data older than `limit`, s, or whose age is not known.
    pub fn stale(&self, now: f64, limit: f64) -> Option<StopReason> {
        let (state, fingers) = self.ages(now);
        let old = |age: f64| !age.is_finite() || age > limit;
        if old(state) {
            return Some(StopReason::StaleState { age: state, limit });
        }
        let (finger, age) = fingers.enumerate().find(|&(_, age)| old(age))?;
        Some(StopReason::StaleForces { finger, age, limit })
    }

    /// The programs that are not there at `now`, s, by name.
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

    /// Whether a hand may begin at `now`, s: all programs are there, and no data are older than `limit`, s.
    pub fn may_begin(&self, now: f64, limit: f64) -> bool {
        self.missing(now).is_empty() && self.stale(now, limit).is_none()
    }

    /// Another hand that is there at `now`, s. A rig has one hand.
    pub fn rival(&self, now: f64) -> Option<&Peer> {
        self.peers().taken(ProgramKind::Hand, now).next()
    }

    /// The hand to which this one, of that `instance`, leaves the rig if it has not begun: one at work, and of two that
    /// wait, that of the smaller instance.
    pub fn hand_ahead(&self, now: f64, instance: u64) -> Option<Mismatch> {
        let rival = self.rival(now)?;
        let Heartbeat {
            rate,
            instance: other,
            ..
        } = rival.heartbeat;
        (rate > 0.0 || other < instance).then(|| rival.taken())
    }

    /// What the hand may do at `now` (s) with data that are stale when older than `limit`, s. What it stopped for by
    /// want of fresh data is over when they are fresh where it `goes_on_by_itself`.
    pub fn verdict(&mut self, now: f64, limit: f64, goes_on_by_itself: bool) -> Verdict {
        let stale = self.stale(now, limit);
        match &stale {
            Some(reason) => self.holds.fault(reason),
            None if goes_on_by_itself => self.holds.resume_stale(),
            None => {}
        }
        let told = || {
            let by = self.holds.ordered_by()?.to_string();
            Some(StopReason::Told { by })
        };
        match self.holds.in_force().is_empty() {
            true => Verdict::Go,
            false => Verdict::Stand(told().or(stale)),
        }
    }
}
