//! The hand program: waits for the others, then runs the control loop on what they publish.

use super::error::{ProgramError, Warn};
use super::hand_config::{HandConfig, HandReport, RemoteLoop};
use super::hand_schedule::{HandSchedule, Lockstep};
use super::hand_status::HandStatus;
use super::hand_supervisor::{HandSupervisor, StepEnd};
use super::node::{Node, first_heartbeat};
use crate::hand_inbox::HandInbox;
use crate::message::{CommandMessage, ProgramKind};
use crate::network::Network;
use crate::peers::Expected;
use crate::remote::{RemoteFinger, RemoteHand, mode_of, waiting_mode};
use crate::run_clock::RunClock;
use crate::shared::Shared;
use crate::topic::Topic;
use feeler::control::control_loop::ControlLoop;
use feeler::control::controller::{ControlConfig, Controller};
use feeler::pace::Pace;
use feeler_record::InstrumentRecord;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time between two looks at whether the other programs are there, s.
const WAITING_PERIOD: f64 = 0.01;

/// Controls a hand whose fingers and drives are in other programs.
///
/// Data older than the stale limit stop the hand, however they were delayed; so does an order on
/// [`Topic::Stop`]. The hand goes on when it is told to, or by itself where the configuration says so.
pub struct HandProgram {
    control_loop: RemoteLoop,
    status: HandStatus,
    /// The command that was sent last.
    command: Shared<Option<CommandMessage>>,
}

impl HandProgram {
    /// A hand that decides by `controller`, on `network`. It commands nothing yet.
    ///
    /// # Errors
    /// When the network does not listen.
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

    /// Warnings go to `warn`: why the hand stops or goes on, and which programs it refuses.
    pub fn set_warn(&mut self, warn: Warn) {
        self.status.node.set_warn(warn);
    }

    /// The controller, as of the newest step.
    pub fn controller(&self) -> &Controller {
        self.control_loop.controller()
    }

    /// The programs that are not there yet, by name.
    pub fn missing(&self) -> Vec<String> {
        self.status.missing()
    }

    /// Waits until all programs are there and their data fresh, and publishes that it does; whether they are, and
    /// `interrupted` was not raised meanwhile. Of programs that do not agree with this one, it warns.
    ///
    /// # Errors
    /// When the network fails.
    pub fn wait_for_others(&mut self, interrupted: &AtomicBool) -> Result<bool, ProgramError> {
        let status = &mut self.status;
        while !interrupted.load(Ordering::Relaxed) {
            for mismatch in status.node.new_refusals() {
                status.node.warn(&format!("refused: {mismatch}"));
            }
            if !status.stands_back() {
                let node = &status.node;
                let mode = waiting_mode(&mut node.inbox.lock(), &node.clock, node.instance);
                node.publish(Topic::Mode, &mode)?;
                // As after each control step: who stops the hand waits for it.
                node.inbox.changed();
                if status.may_begin() {
                    return Ok(true);
                }
            }
            let period = status.period.min(WAITING_PERIOD);
            std::thread::sleep(Duration::from_secs_f64(period));
        }
        Ok(false)
    }

    /// Runs the control loop until the task is done or given up, the time limit is over, `each_step` breaks or
    /// `interrupted` is raised; then commands all fingers to stop. `each_step` sees every step that is worth a
    /// record, with what the rig's instruments read: a hand that stands still for want of data makes none.
    /// Returns what `each_step` broke with, if it did.
    ///
    /// # Errors
    /// When the network or the control loop fails.
    pub fn run<B>(
        &mut self,
        interrupted: &AtomicBool,
        each_step: impl FnMut(&RemoteLoop, InstrumentRecord<'_>) -> ControlFlow<B>,
    ) -> Result<Option<B>, ProgramError> {
        let mut schedule = self.schedule(self.status.limits.period)?;
        self.status.begin();
        let mut supervisor = HandSupervisor::new(&mut self.status, each_step);
        let control_loop = &mut self.control_loop;
        // A step that is missed does no harm of its own: drives stop by themselves without commands, and data that
        // became stale meanwhile stop the hand.
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
            Some(period) => HandSchedule::Paced(Pace::new(period)?),
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

    /// Publishes the mode that the hand ends in. The rig's watchdog stops its drives where nothing arrives any more.
    fn publish_end(&self) {
        let node = &self.status.node;
        let stamp = self.control_loop.state().stamp;
        let mode = mode_of(&node.inbox.lock(), self.controller(), node.instance, stamp);
        // Who hears nothing finds the hand silent.
        let _ = node.publish(Topic::Mode, &mode);
    }

    /// A way to stop the hand from another thread.
    pub fn stopper(&self) -> Stopper {
        Stopper {
            inbox: self.status.node.inbox.clone(),
            longest: stands_still_within(self.status.limits.period),
        }
    }

    /// What came of the run.
    pub fn report(&self) -> HandReport {
        self.status.report(self.control_loop.state().stamp)
    }
}

/// Stops a hand from another thread.
#[derive(Debug, Clone)]
pub struct Stopper {
    inbox: Shared<HandInbox>,
    /// How long the hand may take to stand still before it is taken to hang.
    longest: Duration,
}

/// Four control periods (s), of which two are needed, and not less than a busy computer may need for one.
fn stands_still_within(period: Option<f64>) -> Duration {
    Duration::from_secs_f64((4.0 * period.unwrap_or(0.0)).max(0.1))
}

impl Stopper {
    /// Stops the hand by the order `id` of whoever calls himself `from`; the number of the stop (0 where it was resumed
    /// already), and whether it is still in force after the hand's next control step, by which the hand stands still.
    /// Waits for that, but no longer than four control periods or 0.1 s.
    pub fn stop(&self, id: u64, from: &str) -> (u64, bool) {
        let (number, step) = {
            let mut inbox = self.inbox.lock();
            let number = inbox.holds.order(id, from).unwrap_or(0);
            (number, inbox.sent.newest())
        };
        self.inbox.changed();
        // The step under way may have decided before.
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
