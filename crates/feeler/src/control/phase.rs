//! Where a task stands.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Where the task stands.
///
/// The numbers are those of recordings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
pub enum Phase {
    /// The fingers approach the object.
    #[default]
    Search = 0,
    /// The fingers move the object.
    Move = 1,
    /// The fingers detach.
    Release = 2,
    /// The fingers go home.
    Return = 3,
    /// All strokes are done.
    Done = 4,
    /// The task was given up.
    Stopped = 5,
}

impl Phase {
    /// Every phase, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::Search,
        Self::Move,
        Self::Release,
        Self::Return,
        Self::Done,
        Self::Stopped,
    ];
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
        phase.ok_or_else(|| format!("task phase 0..=5 expected, {number} found"))
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
