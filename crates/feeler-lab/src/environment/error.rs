//! Errors of an environment.

use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use crate::sweep::SweepError;
use feeler::control::ObservationError;
use feeler_sim::optics::PictureError;

/// Error in the setup or a step of an environment.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A distribution of varied values is invalid.
    #[error(transparent)]
    Vary(#[from] SweepError),
    /// An episode could not be set up, or failed.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The observation of a finger could not be computed.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The scene could not be rendered.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// No rewards are defined for the experiment's task.
    #[error(
        "{name}: no rewards are defined for task.{task}; expected task.screw with until = \"strokes\" or \"closed\" and a \
         simulated cap, task.carry or task.grip with a free object, or task.contour with an object that has an outline"
    )]
    NoGoal {
        /// Name of the experiment.
        name: String,
        /// Name of its task.
        task: &'static str,
    },
    /// Random objects are drawn only for a gripper.
    #[error(
        "vary object=random: expected an experiment with task.grip, got {name} with task.{task}"
    )]
    NoRandomObject {
        /// Name of the experiment.
        name: String,
        /// Name of its task.
        task: &'static str,
    },
    /// The varied values change the number of fingers or elements.
    #[error(
        "expected an episode with observations of {expected} numbers, got {actual}; the varied values must not change the fingers or elements"
    )]
    ObservationLength {
        /// Length of the environment's observations.
        expected: usize,
        /// Length of this episode's observations.
        actual: usize,
    },
    /// The length of an action does not match the number of fingers.
    #[error("expected an action of {expected} numbers (3 per finger), got {actual}")]
    ActionLength {
        /// Expected length.
        expected: usize,
        /// Actual length.
        actual: usize,
    },
    /// An action contains a number that is not finite.
    #[error("action[{index}]: expected a finite number, got {value}")]
    ActionNotFinite {
        /// Index of the number.
        index: usize,
        /// Value of the number.
        value: f64,
    },
    /// A step was requested without an active episode.
    #[error("no episode is active: reset the environment first")]
    NoEpisode,
}
