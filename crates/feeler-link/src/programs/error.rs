//! Why a program of a rig ends, and what it warns of.

use crate::endpoints::LinkError;
use crate::mismatch::Mismatch;
use feeler::control::control_loop::ControlError;
use feeler::hand::HandError;
use feeler::pace::PaceError;
use feeler::sensor::reading::SensorError;

/// Takes a warning for whoever runs the program, in one line.
pub type Warn = Box<dyn FnMut(&str) + Send>;

/// Why a program of a rig cannot start or go on.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The network does not carry messages any more.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Another program does not agree with this one.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// The control loop cannot go on.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// There is no such period.
    #[error(transparent)]
    Pace(#[from] PaceError),
    /// The rig's drives or encoders fail.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// The sensor of a finger delivers nothing.
    #[error("finger {finger}: {source}")]
    Sensor {
        /// The finger.
        finger: usize,
        /// What the sensor said.
        source: SensorError,
    },
}
