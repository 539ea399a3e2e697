//! Errors and warnings of a rig's programs.

use crate::messages::mismatch::Mismatch;
use crate::transport::endpoints::LinkError;
use feeler::control::ControlError;
use feeler::hand::HandError;
use feeler::pace::PaceError;
use feeler::sensor::forces::SensorError;

/// Callback for one-line warnings to the operator.
pub type Warn = Box<dyn FnMut(&str) + Send>;

/// Error that ends a program of a rig.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Another program does not match this one.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// The control loop failed.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// Invalid control period.
    #[error(transparent)]
    FixedRate(#[from] PaceError),
    /// The rig's drives or encoders failed.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// The sensor of a finger failed.
    #[error("finger {finger}: {source}")]
    Sensor {
        /// Finger index.
        finger: usize,
        /// Error of the sensor.
        source: SensorError,
    },
}
