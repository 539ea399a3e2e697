//! What the rig (the world, or real drives) has heard of the hand, and what it makes its drives do.

use super::freshness::Echo;
use super::inbox::{Inbox, read};
use super::message::{CommandMessage, HandMode, MessageHeader, NO_FINGER, ProgramKind};
use super::own_stop::OwnStop;
use super::peers::{Expected, Peers};
use super::plausible::{check_protocol, check_velocities};
use super::rejection::{Rejection, Rejections};
use super::sequence::Sequence;
use super::topic::Topic;
use glam::DVec3;

/// Everything that has arrived for the rig, and its watchdog.
#[derive(Debug, Clone)]
pub struct RigInbox {
    fingers: usize,
    /// The rig's instance: what its clock is called.
    clock: u64,
    /// The rig's own time, s, for its owner to keep.
    pub time: f64,
    /// Age from which on data are stale, s.
    limit: f64,
    command: Option<Command>,
    commands: Sequence,
    steps: Sequence,
    /// The hand's newest step, to be echoed.
    pub echo: Echo,
    peers: Peers,
    /// The stop that the rig has ordered, where its drives failed.
    pub(crate) own_stop: Option<OwnStop>,
    /// What was not taken.
    pub rejected: Rejections,
    /// Commands to move that were made from data older than the limit. They are not obeyed.
    pub stale_commands: u64,
    /// How often the watchdog stopped drives that moved.
    pub watchdog_stops: u64,
}

#[derive(Debug, Clone)]
struct Command {
    state_sequence: u64,
    joint_velocity: Vec<DVec3>,
    /// When it came, s on the rig's wall clock.
    heard: f64,
    /// Whether the watchdog has stopped the drives since.
    expired: bool,
}

impl Inbox for RigInbox {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        match topic {
            Topic::Heartbeat(place) => self.peers.heard(place, bytes, now).map(|_| ()),
            Topic::Mode => {
                let mode: HandMode = read(bytes)?;
                self.check_hand(mode.header)?;
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
    /// Nothing has arrived yet for a rig of so many `fingers`, whose program is `instance` and which takes no commands
    /// to move from data older than `limit`, s; programs must agree with `expected`.
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
        check_velocities(self.fingers, &command.joint_velocity)?;
        self.check_hand(header)?;
        let number = (header.instance, header.sequence);
        self.commands.missing(number, now)?;
        // A command that is too old, or for the rig's predecessor, says that the hand is there.
        let step = self.take_step(header, command.token, now);
        let joint_velocity = command.joint_velocity.into_iter().map(DVec3::from);
        let joint_velocity: Vec<DVec3> = joint_velocity.collect();
        if joint_velocity.iter().any(|v| *v != DVec3::ZERO) {
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

    /// Whether a command to move was made from fresh data of this rig.
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

    fn check_hand(&self, header: MessageHeader) -> Result<(), Rejection> {
        check_protocol(header.protocol)?;
        self.peers
            .check(header.instance, &ProgramKind::Hand, NO_FINGER)
    }

    /// Takes in that the hand is at a step; that of a mode is that of the command before.
    fn take_step(&mut self, header: MessageHeader, token: u64, now: f64) -> Result<(), Rejection> {
        let number = (header.instance, header.sequence);
        if self.steps.newest() == Some(number) {
            return Ok(());
        }
        self.steps.missing(number, now)?;
        self.steps.take(number, now);
        self.echo = Echo {
            step: header.sequence,
            token,
            arrived: now,
        };
        Ok(())
    }

    /// Whether a command has ever come.
    pub fn is_commanded(&self) -> bool {
        self.command.is_some()
    }

    /// Whether a command has come that was made from the hand state of this number.
    pub fn has_answered(&self, state_sequence: u64) -> bool {
        let command = self.command.as_ref();
        command.is_some_and(|command| command.state_sequence >= state_sequence)
    }

    /// What the drives do at `now` (s): the newest command's joint velocities, rad/s; none, so that all
    /// stand still, when that came more than `limit` (s) ago. That is the watchdog.
    pub fn drive(&mut self, now: f64, limit: f64) -> Option<&[DVec3]> {
        let command = self.command.as_mut()?;
        if now - command.heard > limit {
            let moved = command.joint_velocity.iter().any(|v| *v != DVec3::ZERO);
            self.watchdog_stops += u64::from(moved && !command.expired);
            command.expired = true;
        }
        (!command.expired).then_some(command.joint_velocity.as_slice())
    }
}
