//! Reasons why a hand was not identified.

use super::estimate::EstimateError;
use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use feeler::control::stop_reason::StopReason;

/// Reason why a hand was not identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The experiment has no rectangle to probe along.
    #[error(
        "expected an experiment with [task.screw] or [task.probe], which give each finger's home, approach and stroke; found [task.{task}]"
    )]
    NoRectangle {
        /// Task of the experiment.
        task: &'static str,
    },
    /// The experiment with the probe in place of its task is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The probing run could not be set up or continue.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The hand stopped before the routine was over.
    #[error("the hand stopped before the probe was over: {reason}")]
    Stopped {
        /// Reason of the stop.
        reason: StopReason,
    },
    /// The time limit of the experiment ended the run.
    #[error(
        "the probe was not over at the experiment's time_limit = {limit} s; expected a limit of 30 s or more"
    )]
    TimeOver {
        /// The limit, s.
        limit: f64,
    },
    /// A quantity cannot be estimated from the run.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
}
