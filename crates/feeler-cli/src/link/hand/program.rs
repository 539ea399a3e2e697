//! The hand program itself: waits for the others, then goes round the control loop on time.

mod telling;
mod waiting;

use crate::CommandError;
use crate::link::{Refusals, expected};
use feeler::control::control_loop::ControlLoop;
use feeler::control::controller::{Controller, Resume};
use feeler::control::phase::Phase;
use feeler::hand::hand::{Hand, HandCommand};
use feeler::pace::{Pace, Punctuality};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::log::{RigRecord, RunLog};
use feeler_lab::experiment::{controller, fingers_at_home, layouts};
use feeler_link::beacon::Beacon;
use feeler_link::hand_inbox::HandInbox;
use feeler_link::inbox::listen;
use feeler_link::message::{HandMode, Heartbeat, Instruments, NO_FINGER, ProgramKind};
use feeler_link::network::Network;
use feeler_link::outlet::{Clock, draw_instance, monotonic, send};
use feeler_link::remote::{RemoteFinger, RemoteHand, mode_of};
use feeler_link::shared::Shared;
use feeler_link::topic::Topic;
use feeler_record::{Cap, TorqueSensor, TrueSlip};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Control steps between two reports of how it goes.
const REPORT_STEPS: u64 = 25;

/// The hand program.
pub struct Program {
    inbox: Shared<HandInbox>,
    network: Arc<dyn Network>,
    beacon: Arc<Beacon>,
    clock: Clock,
    instance: u64,
    control_loop: ControlLoop<RemoteFinger, RemoteHand>,
    punctuality: Punctuality,
    refusals: Refusals,
    /// Whether another hand was there at the last report.
    has_rival: bool,
    /// The control period, s of the rig's time.
    period: f64,
    /// Age at which data are stale, s of the rig's time.
    limit: f64,
    time_limit: f64,
    resume: Resume,
    /// Number of the state that the newest step was made from.
    answered: u64,
    /// The rig's time when the hand began, s.
    began: f64,
    steps: u64,
    fault: String,
    /// The mode that was told last, and when, s.
    told: (HandMode, f64),
}

impl Program {
    /// The hand of `experiment` on `network`; it commands nothing yet.
    pub fn new(experiment: &Experiment, network: Arc<dyn Network>) -> Result<Self, CommandError> {
        let config = &experiment.config;
        let layouts = layouts(config)?;
        let (fingers, _) = fingers_at_home(config)?;
        let elements: Vec<_> = layouts.iter().map(|layout| layout.elements.len()).collect();
        let inbox = Shared::new(HandInbox::new(&elements, expected(experiment)?));
        let (clock, instance) = (monotonic(), draw_instance());
        let heartbeat = Heartbeat {
            instance,
            program: ProgramKind::Hand,
            finger: NO_FINGER,
            experiment: experiment.sha256(),
            age: f64::NAN,
            ..Heartbeat::default()
        };
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let mut topics = vec![Topic::Heartbeat, Topic::State, Topic::Stop, Topic::Resume];
        topics.extend((0..elements.len()).map(Topic::Tactile));
        listen(&*network, &topics, &inbox, &clock, &beacon)?;
        let sensors = elements.iter().enumerate();
        let sensors = sensors.map(|(f, &elements)| RemoteFinger::new(inbox.clone(), f, elements));
        let who = (instance, elements.len());
        let hand = RemoteHand::new(inbox.clone(), network.clone(), clock.clone(), who);
        let controller = controller(config, &fingers, &layouts);
        Ok(Self {
            control_loop: ControlLoop::new(sensors.collect(), hand, controller),
            inbox,
            network,
            beacon,
            clock,
            instance,
            punctuality: Punctuality::new()?,
            refusals: Refusals::default(),
            has_rival: false,
            period: config.control.period,
            limit: config.control.stale_periods * config.control.period,
            time_limit: config.time_limit,
            resume: config.control.resume,
            answered: 0,
            began: 0.0,
            steps: 0,
            fault: String::new(),
            told: (HandMode::default(), f64::NEG_INFINITY),
        })
    }

    /// The controller, as of the newest step.
    pub fn controller(&self) -> &Controller {
        self.control_loop.controller()
    }

    /// Goes round the control loop until the task or the time is over, or `stop` is raised.
    ///
    /// # Errors
    /// When the link or the recording fails.
    pub fn run(&mut self, log: &mut RunLog, stop: &AtomicBool) -> Result<(), CommandError> {
        let (limit, period) = self.limits();
        let mut pace = Pace::new(period.unwrap_or(self.period))?;
        self.began = f64::NAN;
        while !self.is_over() {
            if period.is_some() {
                let Some(tick) = pace.wait_unless(stop) else {
                    return Ok(());
                };
                self.punctuality.record(&tick);
            } else if !self.wait_in_step(stop) {
                return Ok(());
            }
            self.step(limit, log)?;
        }
        Ok(())
    }

    /// One control step: whether data are fresh, decide, command, tell, record.
    fn step(&mut self, limit: f64, log: &mut RunLog) -> Result<(), CommandError> {
        self.steps += 1;
        let stopped_by = self.controller().stop_reason().map(ToString::to_string);
        let went_on = self.heed(limit);
        let (before, instruments) = self.newest_state();
        self.control_loop.step()?;
        let stamp = self.control_loop.state().stamp;
        if self.began.is_nan() {
            self.began = stamp;
        }
        let mode = mode_of(
            &self.inbox.lock(),
            self.control_loop.controller(),
            self.instance,
            stamp,
        );
        self.tell_mode(&mode)?;
        let is_new = before != self.answered;
        self.answered = before;
        let still_stopped = !went_on && stopped_by.as_ref() == Some(&mode.stopped);
        if !still_stopped && !mode.stopped.is_empty() {
            self.say(&format!("stopped: {}", mode.stopped));
        }
        // A hand that stands still for want of data has nothing to add to the record.
        if is_new || !still_stopped {
            let fingers = self.control_loop.state().joints.len();
            let at = instruments.map(|at| recorded(stamp, at, fingers));
            let rig = at
                .as_ref()
                .map_or_else(RigRecord::default, |(torque, cap, slip)| RigRecord {
                    torque: Some(torque),
                    cap: Some(cap),
                    slip: Some(slip),
                });
            log.write_step(&self.control_loop, rig)?;
        }
        if self.steps.is_multiple_of(REPORT_STEPS) {
            self.report(&mode);
        }
        Ok(())
    }

    /// Goes round the control loop once, without a look at how fresh data are; the stamp of the oldest forces, s.
    ///
    /// # Errors
    /// When the link fails.
    pub fn answer(&mut self) -> Result<f64, CommandError> {
        let (state, _) = self.newest_state();
        self.control_loop.step()?;
        self.answered = state;
        let touches = self.control_loop.touches().iter();
        Ok(touches
            .map(|touch| touch.stamp)
            .fold(f64::INFINITY, f64::min))
    }

    /// Stops the hand where data are stale or somebody says so, and lets it go on where it may; whether it
    /// does go on.
    fn heed(&mut self, limit: f64) -> bool {
        let (fault, resume) = {
            let (mut inbox, now) = (self.inbox.lock(), (self.clock)());
            (inbox.fault(now, limit), inbox.take_resume())
        };
        let controller = self.control_loop.controller_mut();
        let stopped = controller.stop_reason();
        match (fault, stopped) {
            (Some(reason), _) => controller.stop(reason),
            (None, Some(stopped)) if stopped.may_pass() => {
                let by_itself = self.resume == Resume::Fresh && stopped.is_stale();
                if resume || by_itself {
                    controller.resume();
                    self.say("going on");
                    return true;
                }
            }
            _ => {}
        }
        false
    }

    fn newest_state(&self) -> (u64, Option<Instruments>) {
        let inbox = self.inbox.lock();
        let state = inbox.state().newest.as_ref();
        let instruments = state.and_then(|state| state.instruments.first().copied());
        (state.map_or(0, |state| state.header.sequence), instruments)
    }

    /// Whether the task is done, was given up for good, or the time is over.
    fn is_over(&self) -> bool {
        let controller = self.controller();
        let given_up = controller
            .stop_reason()
            .is_some_and(|reason| !reason.may_pass());
        controller.phase() == Phase::Done
            || given_up
            || self.control_loop.state().stamp - self.began >= self.time_limit
    }

    /// Commands all fingers to stand still, and says that the hand is done.
    pub fn stand_still(&mut self) {
        let mode = {
            let inbox = self.inbox.lock();
            let stamp = self.control_loop.state().stamp;
            mode_of(&inbox, self.control_loop.controller(), self.instance, stamp)
        };
        let fingers = self.control_loop.state().joints.len();
        let mut hand = RemoteHand::new(
            self.inbox.clone(),
            self.network.clone(),
            self.clock.clone(),
            (self.instance, fingers),
        );
        // The rig's watchdog stops it where this does not arrive.
        let _ = hand.command(&HandCommand::stop(fingers));
        let _ = send(&*self.network, Topic::Mode, &mode);
    }
}

/// The instruments of a rig of so many `fingers`, as they are recorded.
fn recorded(stamp: f64, at: Instruments, fingers: usize) -> (TorqueSensor, Cap, TrueSlip) {
    let torque = TorqueSensor {
        stamp,
        torque: at.torque,
        bridge_voltage: at.bridge_voltage,
        counts: at.counts,
    };
    let cap = Cap {
        stamp,
        angle: at.cap_angle,
        height: at.cap_centre.z,
        centre: at.cap_centre,
        resisting_torque: at.cap_torque,
    };
    let slip = TrueSlip {
        stamp,
        distance: at.slipped.into_iter().take(fingers).collect(),
    };
    (torque, cap, slip)
}
