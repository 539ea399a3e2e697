//! What the hand program knows beside its control loop: it receives orders, publishes its mode, warns, reports.

use super::error::ProgramError;
use super::hand_config::{HandConfig, HandReport, RemoteLoop};
use super::node::Node;
use crate::endpoints::LinkError;
use crate::hand_inbox::HandInbox;
use crate::inbox::Inbox;
use crate::message::{HandMode, ProgramKind};
use crate::mismatch::Mismatch;
use crate::topic::Topic;
use feeler::control::controller::ResumePolicy;
use feeler::control::phase::Phase;
use feeler::pace::Punctuality;

/// Time between two modes that say the same, s: at the usual 100 Hz, every step publishes its own.
const MODE_INTERVAL: f64 = 0.009;

/// What the hand program knows beside its control loop.
pub(super) struct HandStatus {
    pub node: Node<HandInbox>,
    /// The control period, s of the rig's time.
    pub period: f64,
    /// Age at which data are stale, s of the rig's time.
    stale_limit: f64,
    time_limit: f64,
    resume: ResumePolicy,
    pub punctuality: Punctuality,
    /// Whether another hand was there at the last report.
    has_rival: bool,
    /// The rig's time when the hand began, s.
    pub began: f64,
    pub steps: u64,
    warning: String,
    /// The mode that was published last, and when, s.
    published: (HandMode, f64),
}

/// Limits on the hand's own clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Age at which data are stale, s.
    pub stale: f64,
    /// The control period, s; none where the rig waits for the hand.
    pub period: Option<f64>,
}

impl HandStatus {
    pub fn new(node: Node<HandInbox>, config: &HandConfig) -> Result<Self, ProgramError> {
        let control = &config.control;
        Ok(Self {
            node,
            period: control.period,
            stale_limit: control.stale_periods * control.period,
            time_limit: config.time_limit,
            resume: control.resume,
            punctuality: Punctuality::new()?,
            has_rival: false,
            began: f64::NAN,
            steps: 0,
            warning: String::new(),
            published: (HandMode::default(), f64::NEG_INFINITY),
        })
    }

    /// A run begins.
    pub fn begin(&mut self) {
        self.began = f64::NAN;
    }

    /// The programs that are not there.
    pub fn missing(&self) -> Vec<String> {
        let (inbox, now) = (self.node.inbox.lock(), self.node.now());
        let rig = inbox.peers().taken(ProgramKind::World, now).next();
        let rig = rig.is_none().then(|| ProgramKind::World.to_string());
        let fingers = 0..inbox.fingers().len();
        let is_missing = |finger: &usize| {
            let mut sensors = inbox.peers().taken(ProgramKind::Sense, now);
            sensors.all(|peer| peer.heartbeat.finger as usize != *finger)
        };
        let fingers = fingers
            .filter(is_missing)
            .map(|f| format!("sense of finger {f}"));
        rig.into_iter().chain(fingers).collect()
    }

    /// A rig has one hand.
    pub fn other_hand(&self) -> Option<Mismatch> {
        let (inbox, now) = (self.node.inbox.lock(), self.node.now());
        let other = inbox.peers().taken(ProgramKind::Hand, now).next()?;
        let program = other.name();
        Some(Mismatch::Taken { program })
    }

    pub fn is_fresh(&self) -> bool {
        let limit = self.limits().stale;
        let (inbox, now) = (self.node.inbox.lock(), self.node.now());
        let (state, mut fingers) = inbox.ages(now);
        state <= limit && fingers.all(|age| age <= limit)
    }

    /// The limits at the speed of the rig. Where that waits for the hand, data are never stale.
    pub fn limits(&self) -> Limits {
        let (inbox, now) = (self.node.inbox.lock(), self.node.now());
        let rig = inbox.peers().taken(ProgramKind::World, now).next();
        match rig.map_or(1.0, |rig| rig.heartbeat.speed) {
            speed if speed > 0.0 => Limits {
                stale: self.stale_limit / speed,
                period: Some(self.period / speed),
            },
            _ => Limits {
                stale: f64::INFINITY,
                period: None,
            },
        }
    }

    /// Stops the hand where data are stale or somebody orders it, and lets it go on where it may; whether it does go
    /// on.
    pub fn receive_orders(&mut self, control_loop: &mut RemoteLoop, limit: f64) -> bool {
        let (fault, resume) = {
            let (mut inbox, now) = (self.node.inbox.lock(), self.node.now());
            (inbox.fault(now, limit), inbox.take_resume())
        };
        let controller = control_loop.controller_mut();
        match (fault, controller.stop_reason()) {
            (Some(reason), _) => controller.stop(reason),
            (None, Some(stopped)) if stopped.may_pass() => {
                let by_itself = self.resume == ResumePolicy::Fresh && stopped.is_stale();
                if resume || by_itself {
                    controller.resume();
                    self.warn(control_loop, "going on");
                    return true;
                }
            }
            _ => {}
        }
        false
    }

    /// Publishes what the hand does: at once what is new, else no more often than the others need it.
    pub fn publish_mode(&mut self, mode: &HandMode) -> Result<(), LinkError> {
        let now = self.node.now();
        let (published, at) = &self.published;
        let about = |mode: &HandMode| (mode.phase, mode.stroke, mode.stopped.is_empty());
        if about(published) == about(mode) && now - at < MODE_INTERVAL {
            return Ok(());
        }
        self.node.publish(Topic::Mode, mode)?;
        self.published = (mode.clone(), now);
        Ok(())
    }

    /// Warns whoever runs the program, and the other programs with the next heartbeat.
    pub fn warn(&mut self, control_loop: &RemoteLoop, what: &str) {
        let stamp = control_loop.state().stamp;
        self.warning = format!("{stamp:.2} s: {what}");
        self.node.warn(&self.warning);
    }

    /// Reports by heartbeat, and warns of programs that are refused.
    pub fn report_by_heartbeat(&mut self, control_loop: &RemoteLoop, mode: &HandMode) {
        for (_, mismatch) in self.node.new_refusals() {
            self.warn(control_loop, &format!("refused: {mismatch}"));
        }
        let rival = self.other_hand();
        let had_rival = std::mem::replace(&mut self.has_rival, rival.is_some());
        if let Some(mismatch) = rival.filter(|_| !had_rival) {
            self.warn(control_loop, &format!("refused: {mismatch}"));
        }
        let inbox = self.node.inbox.lock();
        let (state, fingers) = inbox.ages(self.node.now());
        let age = fingers.fold(state, f64::max);
        let lost = lost_updates(&inbox) + inbox.state().lost;
        let summary = self.punctuality.summary();
        self.node.beacon.update(|heartbeat| {
            heartbeat.rate = 1.0 / self.period;
            heartbeat.age = age;
            heartbeat.lost = lost;
            heartbeat.refused = inbox.rejected.total();
            heartbeat.missed = summary.missed;
            heartbeat.fault = match mode.stopped.as_str() {
                "" => self.warning.clone(),
                stopped => format!("stopped: {stopped}"),
            };
        });
    }

    /// Whether the task is done, was given up for good, or the time is over.
    pub fn is_over(&self, control_loop: &RemoteLoop) -> bool {
        let controller = control_loop.controller();
        let given_up = controller
            .stop_reason()
            .is_some_and(|reason| !reason.may_pass());
        controller.phase() == Phase::Done
            || given_up
            || control_loop.state().stamp - self.began >= self.time_limit
    }

    /// What came of a run that ended at `stamp`, s of the rig's time.
    pub fn report(&self, stamp: f64) -> HandReport {
        let inbox = self.node.inbox.lock();
        HandReport {
            duration: stamp - self.began,
            steps: self.steps,
            punctuality: self.punctuality.summary(),
            lost: lost_updates(&inbox),
            rejected: inbox.rejected,
        }
    }
}

fn lost_updates(inbox: &HandInbox) -> u64 {
    inbox.fingers().iter().map(|finger| finger.lost).sum()
}
