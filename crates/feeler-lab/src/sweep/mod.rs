//! Sweeps: many randomised trials of one experiment.
//!
//! The random streams of trial `k` depend only on the seed of the sweep and `k`. The result is therefore independent of
//! other trials, their order and the machine. The trials of a `design` instead fill the parameter space evenly and
//! depend only on seed and number.

pub mod analysis;
pub mod engine;
pub mod plan;
pub mod results;
pub mod trial;

pub use crate::sweep::plan::plan_file::{Plan, Shard};
pub use crate::sweep::results::store::Store;
pub use crate::sweep::results::table::Table;
pub use engine::{Ended, Progress};

use std::io;
use std::path::{Path, PathBuf};

/// Error of a sweep that cannot be set up, continued or merged.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The varied parameter is invalid.
    #[error("{said}: {message}")]
    Vary {
        /// The `--vary` expression, or the name of the parameter in a file of ranges.
        said: String,
        /// The problem and the expected form.
        message: String,
    },
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] crate::config::ConfigError),
    /// A part of the rig is invalid.
    #[error(transparent)]
    Experiment(#[from] crate::experiment::ExperimentError),
    /// A trial could not be recorded.
    #[error(transparent)]
    Record(#[from] feeler_record::RecordError),
    /// The policy differs from the policy with which the sweep was started.
    #[error(
        "control.law.policy.file = {file:?}: the policy has the SHA-256 {actual}; expected {expected}, with \
         which the sweep was started"
    )]
    Policy {
        /// The policy file, as named in the experiment.
        file: String,
        /// SHA-256 of the policy with which the sweep was started.
        expected: String,
        /// SHA-256 of the current content of the file.
        actual: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}; {note}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
        /// State of the sweep, or the expected content.
        note: String,
    },
    /// A folder or file has unexpected content.
    #[error("{}: {message}", path.display())]
    Folder {
        /// The folder or file.
        path: PathBuf,
        /// Description of the problem and the expected content.
        message: String,
    },
}

impl SweepError {
    /// Returns a function that adds the file at `path` and a `note` to an error of the operating system.
    pub(crate) fn file(path: &Path, note: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let (path, note) = (path.to_path_buf(), note.into());
        move |source| Self::File { path, source, note }
    }
}
