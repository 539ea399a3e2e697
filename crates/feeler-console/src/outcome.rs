//! Results of a program.

use feeler_record::{RunEnd, RunState};

/// Result of a program whose input was valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Completed.
    Done,
    /// The task gave up, or the run was interrupted.
    GivenUp,
    /// Completed, but a replay differs from its recording, or a calibration is no longer valid.
    Differs,
}

impl From<&RunEnd> for Outcome {
    fn from(end: &RunEnd) -> Self {
        match end.state {
            RunState::Done => Self::Done,
            RunState::GivenUp | RunState::Interrupted => Self::GivenUp,
        }
    }
}

/// Error that ends a program. Its message is all that the user sees.
pub type CommandError = Box<dyn std::error::Error>;
