//! Tuning: computes settings of `[control]` and `[task.screw]` from the identified values of a hand.
//!
//! [`rules`] computes the settings from dimensionless groups, [`search`] improves them in simulation, and
//! [`mod@write`] writes them to the experiment file.

pub mod hand;
pub mod judge;
pub mod optimizer;
pub mod outcome;
pub mod predict;
pub mod rules;
pub mod search;
pub mod settings;
pub mod uncertainty;
pub mod write;

use crate::config::ConfigError;
use crate::experiment::ExperimentError;
use crate::sweep::SweepError;
use std::path::PathBuf;

/// Error that prevents the tuning of a hand.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// The file of identified values cannot be read.
    #[error("{}: {source}; expected the identified values of a hand (TOML)", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file of identified values is invalid.
    #[error("{}: {message}", path.display())]
    Identified {
        /// Path of the file.
        path: PathBuf,
        /// The problem and the expected content.
        message: String,
    },
    /// The experiment cannot be tuned.
    #[error("{name}: {message}")]
    Untunable {
        /// Name of the experiment.
        name: String,
        /// The problem and the expected content.
        message: String,
    },
    /// No hand drawn from the uncertain values is valid.
    #[error("no experiment with drawn values is valid; the last one: {0}")]
    NoHand(Box<ConfigError>),
    /// The experiment is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The experiment cannot be run.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The plausible ranges are invalid.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}
