//! Under which keys messages go.

use std::fmt;

/// What a message is about. Its key is `feeler/RIG/` and what it displays as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Topic {
    /// [`super::message::TactileUpdate`] of a finger.
    Tactile(usize),
    /// [`super::message::PictureMessage`] of a finger.
    Picture(usize),
    /// [`super::message::DirectForces`] of a finger.
    DirectForces(usize),
    /// [`super::message::HandMode`].
    Mode,
    /// [`super::message::CommandMessage`].
    Command,
    /// [`super::message::StateMessage`].
    State,
    /// [`super::message::Heartbeat`] of any program.
    Heartbeat,
    /// [`super::message::StopMessage`].
    Stop,
    /// [`super::message::ResumeMessage`].
    Resume,
}

impl Topic {
    /// Every topic of a rig whose only finger is `finger`.
    pub fn all(finger: usize) -> [Self; 9] {
        [
            Self::Tactile(finger),
            Self::Picture(finger),
            Self::DirectForces(finger),
            Self::Mode,
            Self::Command,
            Self::State,
            Self::Heartbeat,
            Self::Stop,
            Self::Resume,
        ]
    }

    /// The whole key, for the rig called `rig`.
    pub fn key(self, rig: &str) -> String {
        format!("feeler/{rig}/{self}")
    }

    /// Most bytes that a message of this topic may have; more is refused unread.
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
            Self::Heartbeat => f.write_str("heartbeat"),
            Self::Stop => f.write_str("stop"),
            Self::Resume => f.write_str("resume"),
        }
    }
}
