//! State of the hand program outside of its control loop: orders, published mode, warnings and reports.

use super::error::ProgramError;
use super::hand_config::{HandConfig, HandReport, RemoteLoop};
use super::node::Node;
use crate::hand::permission::Permission;
use crate::hand::run_clock::RigSpeed;
use crate::inboxes::hand_inbox::HandInbox;
use crate::inboxes::peers::Peer;
use crate::messages::message::HandMode;
use crate::transport::endpoints::LinkError;
use crate::transport::topic::Topic;
use feeler::control::{ControlConfig, Phase, ResumePolicy, StopReason};
use feeler::pace::Punctuality;

/// Minimum interval between publications of an unchanged mode (s). At the usual 100 Hz, every step publishes its mode.
const MODE_INTERVAL: f64 = 0.009;

/// State of the hand program outside of its control loop.
pub(super) struct HandStatus {
    pub node: Node<HandInbox>,
    pub limits: Limits,
    /// Control period (s, rig time).
    pub period: f64,
    time_limit: f64,
    resume: ResumePolicy,
    pub punctuality: Punctuality,
    /// `true` if another hand program was present at the last report.
    has_rival: bool,
    /// Rig time at the start of the run (s), or NaN before the first step.
    pub began: f64,
    pub steps: u64,
    warning: String,
    /// Last published mode, and its time (s).
    published: (HandMode, f64),
}

/// Limits on the age of data and the control period, on the hand's clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Age above which data is stale (s).
    pub stale: f64,
    /// Control period (s), or `None` in lockstep.
    pub period: Option<f64>,
}

impl Limits {
    /// Creates the limits from the configuration. In lockstep, data is never stale.
    fn of(config: &HandConfig) -> Self {
        let ControlConfig {
            period,
            stale_periods,
            ..
        } = config.control;
        match config.speed {
            RigSpeed::Times(speed) => Self {
                stale: stale_periods * period / speed,
                period: Some(period / speed),
            },
            RigSpeed::Lockstep => Self {
                stale: f64::INFINITY,
                period: None,
            },
        }
    }
}

impl HandStatus {
    pub fn new(node: Node<HandInbox>, config: &HandConfig) -> Result<Self, ProgramError> {
        let control = &config.control;
        Ok(Self {
            node,
            limits: Limits::of(config),
            period: control.period,
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

    /// Returns `true` if this hand program, which has not started, yields to another one. It then sends no heartbeats.
    pub fn stands_back(&mut self) -> bool {
        let (now, instance) = (self.node.now(), self.node.instance);
        let ahead = self.node.inbox.lock().hand_ahead(now, instance);
        self.node.beacon.set_silent(ahead.is_some());
        let had_rival = std::mem::replace(&mut self.has_rival, ahead.is_some());
        if let Some(mismatch) = ahead.as_ref().filter(|_| !had_rival) {
            self.node
                .warn(&format!("{mismatch}: waiting until it is gone"));
        }
        ahead.is_some()
    }

    /// Stops the hand for stale data or stop orders, and resumes it once each stop has been resumed. Returns `true` if
    /// it resumes.
    pub fn receive_orders(&mut self, control_loop: &mut RemoteLoop) -> bool {
        let controller = control_loop.controller_mut();
        let by_itself = self.resume == ResumePolicy::Fresh;
        let verdict = {
            let (mut inbox, now) = (self.node.inbox.lock(), self.node.now());
            inbox.verdict(now, self.limits.stale, by_itself)
        };
        let is_recoverable = controller
            .stop_reason()
            .is_some_and(StopReason::is_recoverable);
        match verdict {
            Permission::Move if is_recoverable => {
                controller.resume();
                self.warn(control_loop, "resuming");
                true
            }
            Permission::ActiveStop(Some(reason)) => {
                controller.stop(reason);
                false
            }
            Permission::Move | Permission::ActiveStop(None) => false,
        }
    }

    /// Adds a stop to the active stops if the controller has stopped the hand, unless a stop is already active.
    pub fn hold_if_stopped(&self, control_loop: &RemoteLoop) {
        if let Some(reason) = control_loop.controller().stop_reason() {
            let mut inbox = self.node.inbox.lock();
            if inbox.holds.in_force().is_empty() {
                inbox.holds.fault(reason);
            }
        }
    }

    /// Publishes the mode: immediately if it has changed, otherwise at most once per [`MODE_INTERVAL`].
    pub fn publish_mode(&mut self, mode: &HandMode) -> Result<(), LinkError> {
        let now = self.node.now();
        let (published, at) = &self.published;
        let about = |mode: &HandMode| (mode.phase, mode.stroke, mode.stopped.is_empty());
        let same = about(published) == about(mode) && published.stops == mode.stops;
        if same && now - at < MODE_INTERVAL {
            return Ok(());
        }
        self.node.publish(Topic::Mode, mode)?;
        self.published = (mode.clone(), now);
        Ok(())
    }

    /// Warns the operator, and the other programs through the next heartbeat.
    pub fn warn(&mut self, control_loop: &RemoteLoop, what: &str) {
        let stamp = control_loop.state().stamp;
        self.warning = format!("{stamp:.2} s: {what}");
        self.node.warn(&self.warning);
    }

    /// Updates the heartbeat, and warns about refused programs.
    pub fn report_by_heartbeat(&mut self, control_loop: &RemoteLoop, mode: &HandMode) {
        for mismatch in self.node.new_refusals() {
            self.warn(control_loop, &format!("refused: {mismatch}"));
        }
        let now = self.node.now();
        let rival = self.node.inbox.lock().rival(now).map(Peer::taken);
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

    /// Returns `true` if the task is done or stopped for an unrecoverable reason, or the time limit is reached.
    pub fn is_over(&self, control_loop: &RemoteLoop) -> bool {
        let controller = control_loop.controller();
        let given_up = controller
            .stop_reason()
            .is_some_and(|reason| !reason.is_recoverable());
        controller.phase() == Phase::Done
            || given_up
            || control_loop.state().stamp - self.began >= self.time_limit
    }

    /// Returns the summary of a run that ended at `stamp` (s, rig time).
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
