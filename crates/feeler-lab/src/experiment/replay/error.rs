//! Errors of a replay.

use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use feeler::control::ControlError;
use feeler_record::RecordError;

/// Error of a recording that cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The experiment is invalid.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The images cannot be read, or the copy cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The recording contains no complete control step.
    #[error("the recording contains no complete control step; expected at least 1")]
    NoSteps,
    /// A replay from images was requested, but the recording has none.
    #[error(
        "the recording contains no images of finger {finger}; expected a run recorded with --record-frames \
         (or replay the forces: --from forces)"
    )]
    NoPictures {
        /// Index of the finger.
        finger: usize,
    },
    /// The experiment describes a rig that differs from the recorded one.
    #[error(
        "{what}: {expected} in the recording, {actual} in the experiment; a replay cannot change this value"
    )]
    OtherRig {
        /// Name of the value.
        what: String,
        /// Recorded value.
        expected: String,
        /// Value in the experiment.
        actual: String,
    },
    /// A control cycle failed.
    #[error(transparent)]
    Control(#[from] ControlError),
}

impl From<ConfigError> for ReplayError {
    fn from(error: ConfigError) -> Self {
        Self::Experiment(error.into())
    }
}
