//! The hand program itself: waits for the others, then goes round the control loop on time.

use crate::cli::CommandError;
use crate::cli::link::{Refusals, expected};
use crate::config::Experiment;
use crate::control::control_loop::ControlLoop;
use crate::control::controller::{Controller, Resume};
use crate::control::phase::Phase;
use crate::control::stop_reason::StopReason;
use crate::experiment::log::RunLog;
use crate::experiment::{controller, fingers_at_home, layouts};
use crate::hand::hand::{Hand, HandCommand};
use crate::link::beacon::Beacon;
use crate::link::hand_inbox::HandInbox;
use crate::link::inbox::{Inbox, listen};
use crate::link::message::{HandMode, Heartbeat, Instruments, NO_FINGER};
use crate::link::network::Network;
use crate::link::outlet::{Clock, draw_instance, monotonic, send};
use crate::link::peers::Mismatch;
use crate::link::remote::{RemoteFinger, RemoteHand, mode_of, waiting_mode};
use crate::link::shared::Shared;
use crate::link::topic::Topic;
use crate::pace::{Pace, Punctuality};
use crate::record::{Cap, TorqueSensor};
use std::io::{self, Write, stderr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long the hand waits for the answer of a world that waits for it, before it looks whether to stop.
const PATIENCE: Duration = Duration::from_millis(200);

/// How long a world that waits for the hand may take for its next step, s.
const HANGS_AFTER: f64 = 5.0;

/// Time between two modes that say the same, s: at the usual 100 Hz, every step says its own.
const MODE_INTERVAL: f64 = 0.009;

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
            program: "hand".into(),
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

    /// The programs that are not there.
    pub fn missing(&self) -> Vec<String> {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let world = inbox.peers().taken("world", now).next();
        let world = world.is_none().then(|| "world".to_string());
        let fingers = 0..inbox.fingers().len();
        let senses = |finger: &usize| {
            let mut senses = inbox.peers().taken("sense", now);
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
    fn other_hand(&self) -> Option<Mismatch> {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let other = inbox.peers().taken("hand", now).next()?;
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
    fn limits(&self) -> (f64, Option<f64>) {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let speed = inbox.peers().taken("world", now).next();
        match speed.map_or(1.0, |world| world.heartbeat.speed) {
            speed if speed > 0.0 => (self.limit / speed, Some(self.period / speed)),
            _ => (f64::INFINITY, None),
        }
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
            let (torque, cap) = recorded(stamp, instruments);
            log.write_step(&self.control_loop, torque.as_ref(), cap.as_ref())?;
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

    /// Tells the others what the hand is about: at once what is new, else no more often than they need it.
    fn tell_mode(&mut self, mode: &HandMode) -> Result<(), CommandError> {
        let now = (self.clock)();
        let (told, at) = &self.told;
        let about = |mode: &HandMode| (mode.phase, mode.stroke, mode.stopped.is_empty());
        if about(told) == about(mode) && now - at < MODE_INTERVAL {
            return Ok(());
        }
        send(&*self.network, Topic::Mode, mode)?;
        self.told = (mode.clone(), now);
        Ok(())
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

    /// Says what happens as it happens.
    fn say(&mut self, what: &str) {
        let stamp = self.control_loop.state().stamp;
        self.fault = format!("{stamp:.2} s: {what}");
        // Where nobody listens, the record says it.
        let _ = writeln!(stderr(), "{}", self.fault);
    }

    /// Tells the other programs how it goes, and the user of programs that are refused.
    fn report(&mut self, mode: &HandMode) {
        let mismatches = self.refusals.new_ones(self.inbox.lock().peers());
        for mismatch in mismatches {
            self.say(&format!("refused: {mismatch}"));
        }
        match self.other_hand() {
            Some(mismatch) if !self.has_rival => self.say(&format!("refused: {mismatch}")),
            _ => {}
        }
        self.has_rival = self.other_hand().is_some();
        let inbox = self.inbox.lock();
        let (state, fingers) = inbox.ages((self.clock)());
        let age = fingers.fold(state, f64::max);
        let lost = inbox.fingers().iter().map(|f| f.lost).sum::<u64>() + inbox.state().lost;
        let summary = self.punctuality.summary();
        self.beacon.update(|heartbeat| {
            heartbeat.rate = 1.0 / self.period;
            heartbeat.age = age;
            heartbeat.lost = lost;
            heartbeat.refused = inbox.rejected.total();
            heartbeat.missed = summary.missed;
            heartbeat.fault = match mode.stopped.as_str() {
                "" => self.fault.clone(),
                stopped => format!("stopped: {stopped}"),
            };
        });
    }

    /// Says how it went.
    pub fn tell(&self, out: &mut dyn Write) -> io::Result<()> {
        let inbox = self.inbox.lock();
        let lost: u64 = inbox.fingers().iter().map(|f| f.lost).sum();
        let took = self.control_loop.state().stamp - self.began;
        writeln!(
            out,
            "{took:.2} s of the rig's time in {} control steps",
            self.steps
        )?;
        writeln!(out, "{}", self.punctuality.summary())?;
        writeln!(
            out,
            "{lost} tactile updates lost; refused: {}",
            inbox.rejected
        )
    }
}

/// The instruments as they are recorded.
fn recorded(stamp: f64, at: Option<Instruments>) -> (Option<TorqueSensor>, Option<Cap>) {
    let torque = at.map(|at| TorqueSensor {
        stamp,
        torque: at.torque,
        bridge_voltage: at.bridge_voltage,
        counts: at.counts,
    });
    let cap = at.map(|at| Cap {
        stamp,
        angle: at.cap_angle,
        height: at.cap_centre.z,
        centre: at.cap_centre,
        resisting_torque: at.cap_torque,
    });
    (torque, cap)
}
