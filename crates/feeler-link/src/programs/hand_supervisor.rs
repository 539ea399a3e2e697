//! Actions of the hand program before and after each control step.

use super::hand_config::RemoteLoop;
use super::hand_schedule::HANGS_AFTER;
use super::hand_status::HandStatus;
use crate::hand::remote::{RemoteFinger, RemoteHand, mode_of};
use crate::messages::instruments::RecordedInstruments;
use crate::messages::message::InstrumentsMessage;
use crate::transport::endpoints::LinkError;
use feeler::control::{StopReason, Supervisor};
use feeler::pace::Tick;
use feeler_record::InstrumentRecord;
use std::ops::ControlFlow;

/// Number of control steps between heartbeat updates.
const REPORT_STEPS: u64 = 25;

/// Reason why a run ended.
pub(super) enum StepEnd<B> {
    /// The task has ended, or the time limit is reached.
    Over,
    /// `each_step` broke with this value.
    Broke(B),
    /// The link failed.
    Link(LinkError),
}

/// Supervisor of the hand's control loop.
pub(super) struct HandSupervisor<'a, F> {
    status: &'a mut HandStatus,
    each_step: F,
    /// Stop reason before the current step, if any.
    stopped_before: Option<String>,
    /// `true` if the hand resumes in the current step.
    went_on: bool,
    /// `true` if the hand was already stopped at the start of the current step.
    stands_still: bool,
    /// Sequence number of the state that the previous step was based on.
    answered: u64,
    /// Sequence number of the state that the current step is based on.
    answers: u64,
    /// Instrument readings in the state that the current step is based on.
    instruments: Option<InstrumentsMessage>,
}

impl<B, F> Supervisor<RemoteFinger, RemoteHand> for HandSupervisor<'_, F>
where
    F: FnMut(&RemoteLoop, InstrumentRecord<'_>) -> ControlFlow<B>,
{
    type Break = StepEnd<B>;

    fn before_step(&mut self, control_loop: &mut RemoteLoop, tick: &Tick) {
        let stopped = control_loop.controller().stop_reason();
        self.stopped_before = stopped.map(ToString::to_string);
        if self.status.limits.period.is_some() {
            self.status.punctuality.record(tick);
        } else if tick.lateness > HANGS_AFTER {
            let (age, limit) = (tick.lateness, HANGS_AFTER);
            let controller = control_loop.controller_mut();
            controller.stop(StopReason::StaleState { age, limit });
            self.status.hold_if_stopped(control_loop);
        }
        self.status.steps += 1;
        self.went_on = self.status.receive_orders(control_loop);
        self.stands_still = control_loop.controller().stop_reason().is_some();
        let inbox = self.status.node.inbox.lock();
        self.answers = inbox.state_sequence();
        let state = inbox.state().newest.as_ref();
        self.instruments = state.and_then(|state| state.instruments.first().copied());
    }

    fn after_step(&mut self, control_loop: &mut RemoteLoop, _: &Tick) -> ControlFlow<StepEnd<B>> {
        let status = &mut *self.status;
        let stamp = control_loop.state().stamp;
        if status.began.is_nan() {
            status.began = stamp;
        }
        // An earlier stop may have been resumed meanwhile and must not be added again.
        if !self.stands_still {
            status.hold_if_stopped(control_loop);
        }
        let mode = {
            let (inbox, instance) = (status.node.inbox.lock(), status.node.instance);
            mode_of(&inbox, control_loop.controller(), instance, stamp)
        };
        if let Err(error) = status.publish_mode(&mode) {
            return ControlFlow::Break(StepEnd::Link(error));
        }
        let is_new = self.answers != self.answered;
        self.answered = self.answers;
        let still_stopped = !self.went_on && self.stopped_before.as_ref() == Some(&mode.stopped);
        if !still_stopped && !mode.stopped.is_empty() {
            status.warn(control_loop, &format!("stopped: {}", mode.stopped));
        }
        // A stopped hand without new data is not recorded.
        if is_new || !still_stopped {
            self.record(control_loop, stamp)?;
        }
        let status = &mut *self.status;
        if status.steps.is_multiple_of(REPORT_STEPS) {
            status.report_by_heartbeat(control_loop, &mode);
        }
        match status.is_over(control_loop) {
            true => ControlFlow::Break(StepEnd::Over),
            false => ControlFlow::Continue(()),
        }
    }
}

impl<'a, B, F> HandSupervisor<'a, F>
where
    F: FnMut(&RemoteLoop, InstrumentRecord<'_>) -> ControlFlow<B>,
{
    pub fn new(status: &'a mut HandStatus, each_step: F) -> Self {
        Self {
            status,
            each_step,
            stopped_before: None,
            went_on: false,
            stands_still: false,
            answered: 0,
            answers: 0,
            instruments: None,
        }
    }

    /// Passes the step and the instrument readings to `each_step`.
    fn record(&mut self, control_loop: &RemoteLoop, stamp: f64) -> ControlFlow<StepEnd<B>> {
        let fingers = control_loop.state().joints.len();
        let read = self.instruments.map(|at| at.recorded(stamp, fingers));
        let instruments = read.as_ref().map(RecordedInstruments::record);
        (self.each_step)(control_loop, instruments.unwrap_or_default()).map_break(StepEnd::Broke)
    }
}
