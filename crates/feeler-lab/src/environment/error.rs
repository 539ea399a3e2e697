//! Why an environment could not be set up or go on.

use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use crate::sweep::SweepError;
use feeler::control::observation::ObservationError;
use feeler_sim::picture::PictureError;

/// Why an environment could not be set up or go on.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// What varies from episode to episode makes no sense.
    #[error(transparent)]
    Vary(#[from] SweepError),
    /// An episode could not be set up or go on.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A finger could not be observed.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The scene could not be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are no rewards for what the experiment is about.
    #[error(
        "{name}: there are no rewards for task.{task}; expected task.screw with until = \"strokes\" or \"closed\" and a \
         simulated cap, task.carry with a free object, or task.contour with an object that has an outline"
    )]
    NoGoal {
        /// Name of the experiment.
        name: String,
        /// Its task.
        task: &'static str,
    },
    /// What varies changes how many fingers or elements there are.
    #[error("episodes with observations of {expected} numbers, this one's have {actual}")]
    ObservationLength {
        /// Numbers of the environment's observation.
        expected: usize,
        /// Numbers of this episode's.
        actual: usize,
    },
    /// An action is for another number of fingers.
    #[error("an action of {expected} numbers, 3 for each finger, expected, {actual} arrived")]
    ActionLength {
        /// Numbers of an action.
        expected: usize,
        /// Numbers that arrived.
        actual: usize,
    },
    /// A number of an action is not finite.
    #[error("action[{index}]: a finite number expected, {value} arrived")]
    ActionNotFinite {
        /// Which number.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// There is no episode under way.
    #[error("there is no episode under way: expected a reset first")]
    NoEpisode,
}
