//! Messages received by the rig (simulated or real drives), and the resulting commands to its drives.

use super::inbox::Inbox;
use super::peers::{Expected, Peers};
use crate::hand::own_stop::RigStop;
use crate::messages::decode::read;
use crate::messages::freshness::Echo;
use crate::messages::message::{CommandMessage, HandMode, MessageHeader};
use crate::messages::plausible::check_velocities;
use crate::messages::rejection::{Rejection, Rejections};
use crate::messages::sequence::Sequence;
use crate::transport::topic::Topic;
use feeler::hand::JointVector;

/// Inbox of the rig, with its watchdog.
#[derive(Debug, Clone)]
pub struct RigInbox {
    fingers: usize,
    /// The rig's instance, which identifies its clock.
    clock: u64,
    /// Current time of the rig (s), set by the caller.
    pub time: f64,
    /// Maximum age of the data that a command is based on (s).
    limit: f64,
    command: Option<Command>,
    commands: Sequence,
    steps: Sequence,
    /// Latest received step of the hand, which messages echo.
    pub echo: Echo,
    peers: Peers,
    /// Stop ordered by the rig itself because its drives failed.
    pub(crate) own_stop: Option<RigStop>,
    /// Counters of rejected messages.
    pub rejected: Rejections,
    /// Number of motion commands rejected because they were based on stale data.
    pub stale_commands: u64,
    /// Number of times that the watchdog stopped moving drives.
    pub watchdog_stops: u64,
}

#[derive(Debug, Clone)]
struct Command {
    state_sequence: u64,
    joint_velocity: Vec<JointVector>,
    /// Time of arrival on the rig's wall clock (s).
    heard: f64,
    /// `true` once the watchdog has stopped the drives.
    expired: bool,
}

impl Inbox for RigInbox {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        match topic {
            Topic::Heartbeat(place) => self.peers.heard(place, bytes, now).map(|_| ()),
            Topic::Mode => {
                let mode: HandMode = read(bytes)?;
                self.peers.check_hand(mode.header)?;
                self.take_step(mode.header, mode.token, now)?;
                if let Some(own) = &mut self.own_stop {
                    own.hear(mode.header.instance, &mode.stops);
                }
                Ok(())
            }
            Topic::Command => read(bytes).and_then(|command| self.take_command(command, now)),
            _ => Err(Rejection::Stranger),
        }
    }

    fn peers(&self) -> &Peers {
        &self.peers
    }

    fn rejected(&mut self) -> &mut Rejections {
        &mut self.rejected
    }
}

impl RigInbox {
    /// Creates an empty inbox for a rig program `instance` with the given number of fingers. Motion commands based on
    /// data older than `limit` (s) are rejected, and other programs must match `expected`.
    pub fn new((fingers, instance): (usize, u64), limit: f64, expected: Expected) -> Self {
        Self {
            fingers,
            clock: instance,
            limit,
            time: 0.0,
            command: None,
            commands: Sequence::default(),
            steps: Sequence::default(),
            echo: Echo::default(),
            peers: Peers::new(expected),
            own_stop: None,
            rejected: Rejections::default(),
            stale_commands: 0,
            watchdog_stops: 0,
        }
    }

    fn take_command(&mut self, command: CommandMessage, now: f64) -> Result<(), Rejection> {
        let header = command.header;
        check_velocities(self.fingers, self.peers.joints(), &command.joint_velocity)?;
        self.peers.check_hand(header)?;
        let number = header.number();
        self.commands.missing(number, now)?;
        // Even a command that is too old, or for a previous rig, proves that the hand is present.
        let step = self.take_step(header, command.token, now);
        let joint_velocity = self.peers.joints().of_message(&command.joint_velocity);
        let joint_velocity: Vec<JointVector> = joint_velocity.collect();
        if joint_velocity.iter().any(|v| *v != JointVector::default()) {
            step?;
            self.check_age(header)?;
        }
        self.commands.take(number, now);
        self.command = Some(Command {
            state_sequence: command.state_sequence,
            joint_velocity,
            heard: now,
            expired: false,
        });
        Ok(())
    }

    /// Checks that a motion command is based on fresh data of this rig.
    fn check_age(&mut self, header: MessageHeader) -> Result<(), Rejection> {
        if header.clock != self.clock {
            return Err(Rejection::Clock);
        }
        let age = (self.time - header.stamp).abs();
        if age.is_nan() || age > self.limit {
            self.stale_commands += 1;
            return Err(Rejection::Old);
        }
        Ok(())
    }

    /// Records the hand's latest step. A mode message contains the same step as the preceding command.
    fn take_step(&mut self, header: MessageHeader, token: u64, now: f64) -> Result<(), Rejection> {
        let number = header.number();
        if self.steps.newest() == Some(number) {
            return Ok(());
        }
        self.steps.accept(number, now)?;
        self.echo = Echo {
            step: header.sequence,
            token,
            arrived: now,
        };
        Ok(())
    }

    /// Returns `true` if any command has arrived.
    pub fn is_commanded(&self) -> bool {
        self.command.is_some()
    }

    /// Returns `true` if a command based on state `state_sequence` or a later one has arrived.
    pub fn has_answered(&self, state_sequence: u64) -> bool {
        let command = self.command.as_ref();
        command.is_some_and(|command| command.state_sequence >= state_sequence)
    }

    /// Returns the joint velocities (rad/s or m/s) to apply at `now` (s), or `None` if the drives must stop. The
    /// watchdog stops them when the latest command arrived more than `limit` (s) ago.
    pub fn drive(&mut self, now: f64, limit: f64) -> Option<&[JointVector]> {
        let command = self.command.as_mut()?;
        if now - command.heard > limit {
            let moved = command
                .joint_velocity
                .iter()
                .any(|v| *v != JointVector::default());
            self.watchdog_stops += u64::from(moved && !command.expired);
            command.expired = true;
        }
        (!command.expired).then_some(command.joint_velocity.as_slice())
    }
}
