//! Errors of the identification of a hand.

use super::estimate::EstimateError;
use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use feeler::control::StopReason;

/// Error of the identification of a hand.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The experiment defines no stroke for the probe: it has neither `[task.screw]` nor `[task.probe]`.
    #[error(
        "expected an experiment with [task.screw] or [task.probe], which define the home, approach and stroke of each finger; got [task.{task}]"
    )]
    NoRectangle {
        /// Task of the experiment.
        task: &'static str,
    },
    /// The experiment is invalid with the probe in place of its task.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The probing run could not be set up, or failed.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The hand stopped before the routine was complete.
    #[error("the hand stopped before the probe was complete: {reason}")]
    Stopped {
        /// Reason for the stop.
        reason: StopReason,
    },
    /// The run reached the time limit of the experiment.
    #[error(
        "the probe was not complete at the experiment's time_limit = {limit} s; set it to 30 s or more"
    )]
    TimeOver {
        /// The limit (s).
        limit: f64,
    },
    /// The run does not determine a quantity.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
}
