//! Topics and keys of messages.

use feeler::hand::MAX_FINGERS;
use std::fmt;

/// Topic of a message. Its key is `feeler/RIG/TOPIC`, where `TOPIC` is its display form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Topic {
    /// [`crate::messages::message::TactileUpdate`] of a finger.
    Tactile(usize),
    /// [`crate::messages::message::PictureMessage`] of a finger.
    Picture(usize),
    /// [`crate::messages::message::DirectForces`] of a finger.
    DirectForces(usize),
    /// [`crate::messages::message::HandMode`].
    Mode,
    /// [`crate::messages::message::CommandMessage`].
    Command,
    /// [`crate::messages::message::StateMessage`].
    State,
    /// [`crate::messages::message::Heartbeat`] of the program with this role.
    Heartbeat(ProgramRole),
    /// [`crate::messages::message::StopMessage`].
    Stop,
    /// [`crate::messages::message::ResumeMessage`].
    Resume,
}

/// Role of a program in a rig. Each role is held by one program at a time, except [`Order`](Self::Order).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProgramRole {
    /// Controls the hand.
    Hand,
    /// Simulates the rig, or serves a real one.
    World,
    /// Measures the forces on a finger.
    Sense(usize),
    /// Sends one order and exits. Several such programs may run at once.
    Order,
}

impl ProgramRole {
    /// Returns all roles.
    pub fn all() -> impl Iterator<Item = Self> {
        let others = [Self::Hand, Self::World, Self::Order];
        others.into_iter().chain((0..MAX_FINGERS).map(Self::Sense))
    }
}

impl fmt::Display for ProgramRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hand => f.write_str("hand"),
            Self::World => f.write_str("world"),
            Self::Sense(finger) => write!(f, "sense/{finger}"),
            Self::Order => f.write_str("order"),
        }
    }
}

impl Topic {
    /// Returns all topics of a rig whose only finger is `finger`.
    pub fn all(finger: usize) -> [Self; 12] {
        [
            Self::Tactile(finger),
            Self::Picture(finger),
            Self::DirectForces(finger),
            Self::Mode,
            Self::Command,
            Self::State,
            Self::Heartbeat(ProgramRole::Hand),
            Self::Heartbeat(ProgramRole::World),
            Self::Heartbeat(ProgramRole::Sense(finger)),
            Self::Heartbeat(ProgramRole::Order),
            Self::Stop,
            Self::Resume,
        ]
    }

    /// Returns the full key for the rig named `rig`.
    pub fn key(self, rig: &str) -> String {
        format!("feeler/{rig}/{self}")
    }

    /// Returns the heartbeat topics of all roles.
    pub fn heartbeats() -> impl Iterator<Item = Self> {
        ProgramRole::all().map(Self::Heartbeat)
    }

    /// Returns the maximum message size in bytes. Longer messages are rejected unread.
    pub fn most_bytes(self) -> usize {
        match self {
            Self::Picture(_) => 64 << 20,
            _ => 64 << 10,
        }
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tactile(finger) => write!(f, "finger/{finger}/tactile"),
            Self::Picture(finger) => write!(f, "finger/{finger}/picture"),
            Self::DirectForces(finger) => write!(f, "finger/{finger}/forces"),
            Self::Mode => f.write_str("hand/mode"),
            Self::Command => f.write_str("hand/command"),
            Self::State => f.write_str("hand/state"),
            Self::Heartbeat(place) => write!(f, "heartbeat/{place}"),
            Self::Stop => f.write_str("stop"),
            Self::Resume => f.write_str("resume"),
        }
    }
}
