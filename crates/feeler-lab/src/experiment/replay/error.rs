//! What can go wrong with a replay.

use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use feeler::control::control_loop::ControlError;
use feeler_record::RecordError;

/// Why a recording cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The experiment makes no sense.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The pictures cannot be read, or the copy not be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// There is nothing to replay.
    #[error("there is no whole control step on record; expected at least 1")]
    NoSteps,
    /// Forces are to come from pictures that were not recorded.
    #[error(
        "there are no pictures of finger {finger} on record; expected a run made with --record-frames \
         (its forces can be replayed: --from forces)"
    )]
    NoPictures {
        /// The finger.
        finger: usize,
    },
    /// The settings are of another rig than the recording.
    #[error("{what}: {expected} on record, {actual} in the experiment; a replay cannot change it")]
    OtherRig {
        /// What differs.
        what: String,
        /// What is on record.
        expected: String,
        /// What the experiment says.
        actual: String,
    },
    /// The loop could not go round.
    #[error(transparent)]
    Control(#[from] ControlError),
}

impl From<ConfigError> for ReplayError {
    fn from(error: ConfigError) -> Self {
        Self::Experiment(error.into())
    }
}
