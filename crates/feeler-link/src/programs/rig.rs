//! Rig program: publishes encoder, instrument and camera data, and executes the hand's commands.

use super::error::{ProgramError, Warn};
use super::node::{Node, first_heartbeat};
use super::rig_config::{Rig, RigConfig};
use super::rig_reading::{Exposed, Reading};
use crate::hand::run_clock::RigSpeed;
use crate::inboxes::rig_inbox::RigInbox;
use crate::messages::message::ProgramKind;
use crate::messages::rejection::Rejections;
use crate::transport::network::Network;
use crate::transport::topic::Topic;
use feeler::hand::{HandCommand, HandState};
use feeler::pace::FixedRate;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time to wait for the hand's answer in lockstep before the data is published again and the interrupt flag checked.
const PATIENCE: Duration = Duration::from_millis(200);

/// Program that serves a rig. Its drives follow the hand program's commands while these are fresh.
pub struct RigProgram<R> {
    pub(super) rig: R,
    pub(super) node: Node<RigInbox>,
    pub(super) config: RigConfig,
    pub(super) sequence: u64,
    pub(super) state: HandState,
    pub(super) command: HandCommand,
    /// Latest image of each finger.
    pub(super) exposed: Vec<Option<Exposed>>,
    pub(super) missed: u64,
    pub(super) warning: String,
    /// Number of drive failures, and time of the latest stop order that they caused (s).
    pub(super) faults: (u64, f64),
    /// Latest readings, kept to be published again in lockstep.
    pub(super) published: Vec<Reading>,
    /// Sequence number and time (s) of the last report.
    pub(super) reported: (u64, f64),
}

/// Summary of a rig program.
#[derive(Debug, Clone)]
pub struct RigReport {
    /// Rig time (s).
    pub time: f64,
    /// Number of missed step periods, by which the rig falls behind real time.
    pub missed: u64,
    /// Number of motion commands rejected because they were based on stale data.
    pub stale_commands: u64,
    /// Number of times that the watchdog stopped moving drives.
    pub watchdog_stops: u64,
    /// Number of drive and encoder failures.
    pub faults: u64,
    /// Counters of rejected messages.
    pub rejected: Rejections,
}

impl<R: Rig> RigProgram<R> {
    /// Creates a program that serves `rig` on `network`.
    ///
    /// # Errors
    /// If the network fails.
    pub fn new(
        rig: R,
        config: &RigConfig,
        network: Arc<dyn Network>,
    ) -> Result<Self, ProgramError> {
        let fingers = rig.finger_count();
        let limit = match config.speed {
            // One more period allows for the transmission of the command.
            RigSpeed::Times(_) => (config.stale_periods + 1.0) * config.period,
            RigSpeed::Lockstep => f64::INFINITY,
        };
        let mut heartbeat = first_heartbeat(ProgramKind::World, &config.expected.experiment);
        heartbeat.speed = config.speed.times();
        let identity = (fingers, heartbeat.instance);
        let inbox = RigInbox::new(identity, limit, config.expected.clone());
        let topics = [Topic::Mode, Topic::Command];
        Ok(Self {
            node: Node::start(network, heartbeat, inbox, &topics)?,
            rig,
            config: config.clone(),
            sequence: 0,
            state: HandState::zero(fingers),
            command: HandCommand::stop(fingers),
            exposed: vec![None; fingers],
            missed: 0,
            warning: String::new(),
            faults: (0, 0.0),
            published: Vec::new(),
            reported: (0, 0.0),
        })
    }

    /// Sets the callback for warnings about refused programs and failed drives.
    pub fn set_warn(&mut self, warn: Warn) {
        self.node.set_warn(warn);
    }

    /// Serves the rig until `interrupted` is set, then stops its drives.
    ///
    /// # Errors
    /// If the rig or the network fails.
    pub fn run(&mut self, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        let ended = match self.config.speed {
            RigSpeed::Times(speed) => self.run_in_time(speed, interrupted),
            RigSpeed::Lockstep => self.run_in_lockstep(interrupted),
        };
        self.command.set_to_stop();
        let stopped = self.rig.advance(&self.command);
        ended.and(self.survive(stopped))
    }

    /// Ends the program, and returns its rig.
    pub fn into_rig(self) -> R {
        self.rig
    }

    /// Serves the rig at a fixed rate, independent of the hand. Rig time starts with the hand's first command.
    fn run_in_time(&mut self, speed: f64, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        let watchdog = (self.config.stale_periods + 1.0) * self.config.period / speed;
        let steps = self.rig.steps_per_period();
        let mut pace = FixedRate::new(self.config.period / steps as f64 / speed)?;
        while !interrupted.load(Ordering::Relaxed) {
            self.publish_or_fail()?;
            self.rig.begin_period();
            for _ in 0..steps {
                let Some(tick) = pace.wait_interruptible(interrupted) else {
                    return Ok(());
                };
                // Every step is executed: a late rig falls behind real time by the missed periods.
                self.missed += tick.missed;
                self.drive(watchdog)?;
            }
        }
        Ok(())
    }

    /// Executes the hand's latest command, or stops the drives if the command is older than `watchdog` (s).
    fn drive(&mut self, watchdog: f64) -> Result<(), ProgramError> {
        let now = self.node.now();
        let mut inbox = self.node.inbox.lock();
        if !inbox.is_commanded() {
            return Ok(());
        }
        let has_failed = inbox.own_stop.is_some();
        match inbox.drive(now, watchdog) {
            Some(velocities) if !has_failed => self.command.relay(velocities),
            _ => self.command.set_to_stop(),
        }
        drop(inbox);
        let moved = self.rig.advance(&self.command);
        self.survive(moved)?;
        self.update_time();
        Ok(())
    }

    /// Serves the rig in lockstep: waits for the hand's answer in every period.
    fn run_in_lockstep(&mut self, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        self.publish()?;
        while !interrupted.load(Ordering::Relaxed) {
            let sequence = self.sequence;
            let answered = |inbox: &mut RigInbox| inbox.has_answered(sequence);
            if !self.node.inbox.wait_for(PATIENCE, answered) {
                self.publish_again()?;
                continue;
            }
            let now = self.node.now();
            if let Some(velocities) = self.node.inbox.lock().drive(now, f64::INFINITY) {
                self.command.relay(velocities);
            }
            self.rig.begin_period();
            for _ in 0..self.rig.steps_per_period() {
                self.rig.advance(&self.command)?;
            }
            self.update_time();
            self.publish()?;
        }
        Ok(())
    }

    /// Passes the rig time to the inbox, which computes the ages of commands from it.
    pub(super) fn update_time(&self) {
        self.node.inbox.lock().time = self.rig.time();
    }

    /// Returns a summary of the program so far.
    pub fn report(&self) -> RigReport {
        let inbox = self.node.inbox.lock();
        RigReport {
            time: self.rig.time(),
            missed: self.missed,
            stale_commands: inbox.stale_commands,
            watchdog_stops: inbox.watchdog_stops,
            faults: self.faults.0,
            rejected: inbox.rejected,
        }
    }
}

impl fmt::Display for RigReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.2} s served; {} periods missed, {} stale commands refused, {} stops by the watchdog, {} faults of the drives, refused: {}",
            self.time,
            self.missed,
            self.stale_commands,
            self.watchdog_stops,
            self.faults,
            self.rejected,
        )
    }
}
