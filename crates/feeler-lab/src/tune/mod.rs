//! Tuning: settings of `[control]` and `[task.screw]` from the identified values of a hand.
//!
//! [`rules`] compute the settings from dimensionless groups, [`search`] improves them in simulation, [`mod@write`] puts them
//! into the experiment's text.

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

/// Why a hand could not be tuned.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// The file of identified values could not be read.
    #[error("{}: {source}; expected the identified values of a hand (TOML)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file of identified values is not valid.
    #[error("{}: {message}", path.display())]
    Identified {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        message: String,
    },
    /// The experiment cannot be tuned.
    #[error("{name}: {message}")]
    Untunable {
        /// Name of the experiment.
        name: String,
        /// What was found and what was expected.
        message: String,
    },
    /// No plausible hand could be drawn.
    #[error("no experiment with drawn values is valid; the last one: {0}")]
    NoHand(Box<ConfigError>),
    /// The experiment is not valid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The experiment cannot be run.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The plausible ranges are not valid.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}
