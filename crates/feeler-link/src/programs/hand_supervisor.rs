//! The hand program around each step of its control loop.

use super::hand_config::RemoteLoop;
use super::hand_schedule::HANGS_AFTER;
use super::hand_status::HandStatus;
use crate::endpoints::LinkError;
use crate::instruments::RecordedInstruments;
use crate::message::InstrumentsMessage;
use crate::remote::{RemoteFinger, RemoteHand, mode_of};
use feeler::control::control_loop::Supervisor;
use feeler::control::stop_reason::StopReason;
use feeler::pace::Tick;
use feeler_record::InstrumentRecord;
use std::ops::ControlFlow;

/// Control steps between two reports by heartbeat.
const REPORT_STEPS: u64 = 25;

/// Why a run ended between two steps.
pub(super) enum StepEnd<B> {
    /// The task or the time is over.
    Over,
    /// The caller broke.
    Broke(B),
    /// The network fails.
    Link(LinkError),
}

/// The hand program around each step of its control loop.
pub(super) struct HandSupervisor<'a, F> {
    status: &'a mut HandStatus,
    each_step: F,
    /// Why the hand was stopped before the step under way, if it was.
    stopped_before: Option<String>,
    /// Whether it goes on with the step under way.
    went_on: bool,
    /// Whether it stands still in the step under way by what was known before.
    stands_still: bool,
    /// Number of the state that the step before was made from.
    answered: u64,
    /// Number of the state that the step under way is made from.
    answers: u64,
    /// What the instruments read in that state.
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
        // What stopped it before may have been resumed meanwhile.
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
        // A hand that stands still for want of data has nothing to add to the record.
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

    /// Hands the step on to the caller, with what the instruments read.
    fn record(&mut self, control_loop: &RemoteLoop, stamp: f64) -> ControlFlow<StepEnd<B>> {
        let fingers = control_loop.state().joints.len();
        let read = self.instruments.map(|at| at.recorded(stamp, fingers));
        let instruments = read.as_ref().map(RecordedInstruments::record);
        (self.each_step)(control_loop, instruments.unwrap_or_default()).map_break(StepEnd::Broke)
    }
}
