//! Hand program: waits for the other programs, then runs the control loop on their data.

use super::error::{ProgramError, Warn};
use super::hand_config::{HandConfig, HandReport, RemoteLoop};
use super::hand_schedule::{HandSchedule, Lockstep};
use super::hand_status::HandStatus;
use super::hand_supervisor::{HandSupervisor, StepEnd};
use super::node::{Node, first_heartbeat};
use crate::hand::remote::{RemoteFinger, RemoteHand, mode_of, waiting_mode};
use crate::hand::run_clock::RunClock;
use crate::inboxes::hand_inbox::HandInbox;
use crate::inboxes::peers::Expected;
use crate::messages::message::{CommandMessage, ProgramKind};
use crate::transport::network::Network;
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use feeler::control::{ControlConfig, ControlLoop, Controller};
use feeler::pace::FixedRate;
use feeler_record::InstrumentRecord;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Maximum interval for checking whether the other programs are present (s).
const WAITING_PERIOD: f64 = 0.01;

/// Program that controls a hand whose fingers and drives are in other programs.
///
/// Stale data and orders on [`Topic::Stop`] stop the hand. It resumes on an order or, if configured, automatically once
/// the data is fresh again.
pub struct HandProgram {
    control_loop: RemoteLoop,
    status: HandStatus,
    /// Last command sent.
    command: Shared<Option<CommandMessage>>,
}

impl HandProgram {
    /// Creates a hand program with the given controller. It sends no commands before [`run`](Self::run).
    ///
    /// # Errors
    /// If the network fails.
    pub fn new(
        config: &HandConfig,
        controller: Controller,
        network: Arc<dyn Network>,
    ) -> Result<Self, ProgramError> {
        let elements = &config.elements;
        let ControlConfig {
            period,
            stale_periods,
            ..
        } = config.control;
        let clock = RunClock::new(config.speed, period, stale_periods);
        let expected = Expected {
            speed: Some(config.speed.times()),
            ..config.expected.clone()
        };
        let inbox = HandInbox::new(elements, clock, expected);
        let heartbeat = first_heartbeat(ProgramKind::Hand, &config.expected.experiment);
        let mut topics = vec![Topic::State, Topic::Stop, Topic::Resume];
        topics.extend((0..elements.len()).map(Topic::Tactile));
        let node = Node::start(network, heartbeat, inbox, &topics)?;
        let fingers = elements.iter().enumerate();
        let fingers = fingers.map(|(f, &count)| RemoteFinger::new(node.inbox.clone(), f, count));
        let hand = RemoteHand::new(
            node.inbox.clone(),
            node.network.clone(),
            node.clock.clone(),
            (node.instance, elements.len()),
        );
        Ok(Self {
            command: hand.newest_command(),
            control_loop: ControlLoop::new(fingers.collect(), hand, controller),
            status: HandStatus::new(node, config)?,
        })
    }

    /// Sets the callback for warnings, which report stops, resumptions and refused programs.
    pub fn set_warn(&mut self, warn: Warn) {
        self.status.node.set_warn(warn);
    }

    /// Returns the controller.
    pub fn controller(&self) -> &Controller {
        self.control_loop.controller()
    }

    /// Returns the names of the missing programs.
    pub fn missing(&self) -> Vec<String> {
        let node = &self.status.node;
        node.inbox.lock().missing(node.now())
    }

    /// Waits until all programs are present with fresh data, publishing modes meanwhile. Returns `false` if
    /// `interrupted` was set. Warns about programs that do not match this one.
    ///
    /// # Errors
    /// If the network fails.
    pub fn wait_for_others(&mut self, interrupted: &AtomicBool) -> Result<bool, ProgramError> {
        let status = &mut self.status;
        while !interrupted.load(Ordering::Relaxed) {
            status.node.warn_of_refusals();
            if !status.stands_back() {
                let node = &status.node;
                let mode = waiting_mode(&mut node.inbox.lock(), &node.clock, node.instance);
                node.publish(Topic::Mode, &mode)?;
                // As after each control step: wakes `Stopper::stop`.
                node.inbox.changed();
                let stale = status.limits.stale;
                if node.inbox.lock().may_begin(node.now(), stale) {
                    return Ok(true);
                }
            }
            let period = status.period.min(WAITING_PERIOD);
            std::thread::sleep(Duration::from_secs_f64(period));
        }
        Ok(false)
    }

    /// Runs the control loop until the task is done or aborted, the time limit is reached, `each_step` breaks or
    /// `interrupted` is set, and then stops all fingers. Returns the value with which `each_step` broke, if any.
    ///
    /// `each_step` is called with the instrument readings after every step, except steps of a stopped hand without new
    /// data.
    ///
    /// # Errors
    /// If the network or the control loop fails.
    pub fn run<B>(
        &mut self,
        interrupted: &AtomicBool,
        each_step: impl FnMut(&RemoteLoop, InstrumentRecord<'_>) -> ControlFlow<B>,
    ) -> Result<Option<B>, ProgramError> {
        let mut schedule = self.schedule(self.status.limits.period)?;
        self.status.began = f64::NAN;
        let mut supervisor = HandSupervisor::new(&mut self.status, each_step);
        let control_loop = &mut self.control_loop;
        // Any number of missed steps is allowed: the watchdog stops the drives without commands, and stale data stops
        // the hand.
        let ended =
            control_loop.run_supervised(&mut schedule, u64::MAX, interrupted, &mut supervisor);
        self.publish_end();
        match ended? {
            Some(StepEnd::Link(error)) => Err(error.into()),
            Some(StepEnd::Broke(value)) => Ok(Some(value)),
            Some(StepEnd::Over) | None => Ok(None),
        }
    }

    fn schedule(&self, period: Option<f64>) -> Result<HandSchedule, ProgramError> {
        let node = &self.status.node;
        Ok(match period {
            Some(period) => HandSchedule::Paced(FixedRate::new(period)?),
            None => HandSchedule::Lockstep(Lockstep {
                inbox: node.inbox.clone(),
                clock: node.clock.clone(),
                network: node.network.clone(),
                command: self.command.clone(),
                answered: 0,
                steps: 0,
            }),
        })
    }

    /// Publishes the final mode. Afterwards, the rig's watchdog stops the drives, because no more commands arrive.
    fn publish_end(&self) {
        let node = &self.status.node;
        let stamp = self.control_loop.state().stamp;
        let mode = mode_of(&node.inbox.lock(), self.controller(), node.instance, stamp);
        // If this fails, other programs notice that the hand is silent.
        let _ = node.publish(Topic::Mode, &mode);
    }

    /// Returns a handle for stopping the hand from another thread.
    pub fn stopper(&self) -> Stopper {
        Stopper {
            inbox: self.status.node.inbox.clone(),
            longest: stands_still_within(self.status.limits.period),
        }
    }

    /// Returns a summary of the run.
    pub fn report(&self) -> HandReport {
        self.status.report(self.control_loop.state().stamp)
    }
}

/// Handle for stopping a hand from another thread.
#[derive(Debug, Clone)]
pub struct Stopper {
    inbox: Shared<HandInbox>,
    /// Maximum time to stop, after which the hand is considered hanging.
    longest: Duration,
}

/// Returns the maximum time to stop: four control periods (s), although two suffice, but at least 0.1 s for loaded
/// machines.
fn stands_still_within(period: Option<f64>) -> Duration {
    Duration::from_secs_f64((4.0 * period.unwrap_or(0.0)).max(0.1))
}

impl Stopper {
    /// Stops the hand with the order `id` from the sender `from`, and waits until it stands still, for at most four
    /// control periods or 0.1 s, whichever is longer.
    ///
    /// Returns the number of the stop (0 if the order has already been resumed), and `true` if the hand has stopped and
    /// the stop is still active.
    pub fn stop(&self, id: u64, from: &str) -> (u64, bool) {
        let (number, step) = {
            let mut inbox = self.inbox.lock();
            let number = inbox.holds.order(id, from).unwrap_or(0);
            (number, inbox.sent.newest())
        };
        self.inbox.changed();
        // The current step may have been decided before the stop.
        let stepped = |inbox: &mut HandInbox| inbox.sent.newest() > step + 1;
        let stepped = self.inbox.wait_for(self.longest, stepped);
        let inbox = self.inbox.lock();
        let in_force = inbox
            .holds
            .in_force()
            .iter()
            .any(|hold| hold.number == number);
        (number, stepped && in_force)
    }
}
