//! The rig program: publishes what encoders, instruments and cameras read, and moves the drives as commanded.

use super::error::{ProgramError, Warn};
use super::node::{Node, first_heartbeat};
use super::rig_config::{Rig, RigConfig};
use super::rig_publish::Reading;
use crate::freshness::Echo;
use crate::message::ProgramKind;
use crate::network::Network;
use crate::rejection::Rejections;
use crate::rig_inbox::RigInbox;
use crate::run_clock::RigSpeed;
use crate::topic::Topic;
use feeler::hand::{HandCommand, HandState};
use feeler::pace::Pace;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long to wait for the hand's answer before all is published again, and before looking whether to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// Serves a rig: its drives do what the hand program commands, for as long as its commands are fresh.
pub struct RigProgram<R> {
    pub(super) rig: R,
    pub(super) node: Node<RigInbox>,
    pub(super) config: RigConfig,
    pub(super) sequence: u64,
    pub(super) state: HandState,
    pub(super) command: HandCommand,
    /// Each finger's newest picture.
    pub(super) exposed: Vec<Option<Exposed>>,
    pub(super) missed: u64,
    pub(super) warning: String,
    /// How often the drives failed, and when the stop for it was last ordered, s.
    pub(super) faults: (u64, f64),
    /// The newest readings, to be published again, where the hand is waited for.
    pub(super) published: Vec<Reading>,
    /// Sequence number and time (s) of the last report.
    pub(super) reported: (u64, f64),
}

/// A picture of a finger that was published.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exposed {
    pub number: u64,
    /// The hand's newest step when it was taken, and the time then, s.
    pub taken: (Echo, f64),
}

/// What came of a rig program.
#[derive(Debug, Clone)]
pub struct RigReport {
    /// The rig's time, s.
    pub time: f64,
    /// Steps whose time went by before they were made.
    pub missed: u64,
    /// Commands to move that were made from stale data, and not obeyed.
    pub stale_commands: u64,
    /// How often the watchdog stopped drives that moved.
    pub watchdog_stops: u64,
    /// How often drives or encoders failed.
    pub faults: u64,
    /// Messages that were refused.
    pub rejected: Rejections,
}

impl<R: Rig> RigProgram<R> {
    /// Serves `rig` on `network`.
    ///
    /// # Errors
    /// When the network does not listen.
    pub fn new(
        rig: R,
        config: &RigConfig,
        network: Arc<dyn Network>,
    ) -> Result<Self, ProgramError> {
        let fingers = rig.finger_count();
        let limit = match config.speed {
            // What a command takes on its way is no fault of the hand's: it has a period for that.
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

    /// Warnings go to `warn`: which programs it refuses.
    pub fn set_warn(&mut self, warn: Warn) {
        self.node.set_warn(warn);
    }

    /// Serves the rig until `interrupted` is raised; then stops its drives.
    ///
    /// # Errors
    /// When the rig or the network fails.
    pub fn run(&mut self, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        let ended = match self.config.speed {
            RigSpeed::Times(speed) => self.run_in_time(speed, interrupted),
            RigSpeed::Lockstep => self.run_in_lockstep(interrupted),
        };
        self.command.set_to_stop();
        let stopped = self.rig.advance(&self.command);
        ended.and(self.survive(stopped))
    }

    /// Goes on in time, whatever comes of the hand. The rig's time begins with the hand's first command.
    fn run_in_time(&mut self, speed: f64, interrupted: &AtomicBool) -> Result<(), ProgramError> {
        let watchdog = (self.config.stale_periods + 1.0) * self.config.period / speed;
        let steps = self.rig.steps_per_period();
        let mut pace = Pace::new(self.config.period / steps as f64 / speed)?;
        while !interrupted.load(Ordering::Relaxed) {
            self.publish_or_fail()?;
            self.rig.begin_period();
            for _ in 0..steps {
                let Some(tick) = pace.wait_unless(interrupted) else {
                    return Ok(());
                };
                // No step is left out: the rig is late then, and says how much.
                self.missed += tick.missed;
                self.drive(watchdog)?;
            }
        }
        Ok(())
    }

    /// Has the drives do what the hand commands, or stand still where that came more than `watchdog` (s) ago.
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

    /// Waits for the hand's answer to every period, and loses none.
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

    /// Ages of commands are told by the rig's time.
    pub(super) fn update_time(&self) {
        self.node.inbox.lock().time = self.rig.time();
    }

    /// What came of the program so far.
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
