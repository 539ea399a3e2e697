//! Phases of a task.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Phase of a task.
///
/// The numeric values are stored in recordings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
pub enum Phase {
    /// Search: the fingers approach the object.
    #[default]
    Search = 0,
    /// Move: the fingers move the object.
    Move = 1,
    /// Release: the fingers release the object.
    Release = 2,
    /// Return: the fingers return to their home positions.
    Return = 3,
    /// Done: the task has ended.
    Done = 4,
    /// Stopped: the hand was stopped.
    Stopped = 5,
}

impl Phase {
    /// All phases, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::Search,
        Self::Move,
        Self::Release,
        Self::Return,
        Self::Done,
        Self::Stopped,
    ];

    /// Returns `true` if the task is over: done or stopped.
    pub fn is_final(self) -> bool {
        matches!(self, Self::Done | Self::Stopped)
    }
}

impl From<Phase> for u8 {
    fn from(phase: Phase) -> Self {
        phase as u8
    }
}

impl TryFrom<u8> for Phase {
    type Error = String;

    fn try_from(number: u8) -> Result<Self, Self::Error> {
        let phase = Self::ALL.get(usize::from(number)).copied();
        phase.ok_or_else(|| format!("expected a task phase from 0 to 5, got {number}"))
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Search => "SEARCH",
            Self::Move => "MOVE",
            Self::Release => "RELEASE",
            Self::Return => "RETURN",
            Self::Done => "DONE",
            Self::Stopped => "STOPPED",
        })
    }
}
