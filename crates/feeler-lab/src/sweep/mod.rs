//! Many randomised trials of one experiment: what varies, how trials run, and what is kept of them.
//!
//! Trial `k` draws all that it is made of from streams of its own, which sweep seed and `k` alone
//! determine. So it comes out the same whatever ran before it, beside it, or on another machine. The trials of
//! a [`design`] fill the space of what varies instead; they, too, follow from seed and number alone.

pub mod claim_columns;
pub mod comparison;
pub mod design;
pub mod distribution;
pub mod engine;
pub mod files;
pub mod interval;
pub mod law_shares;
pub mod multiplier;
pub mod parameter;
pub mod plan;
pub mod plausible;
pub mod ranges;
pub mod robustness;
pub mod sensitivity;
pub mod slip_score;
pub mod store;
mod stroke_columns;
pub mod summary;
pub mod table;
pub mod trial;

pub use engine::{Ended, Progress};
pub use plan::{Plan, Shard};
pub use store::Store;
pub use table::Table;

use std::path::PathBuf;

/// Why a sweep could not be set up, go on or be joined.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// What is to vary makes no sense.
    #[error("{said}: {message}")]
    Vary {
        /// The `--vary` expression, or the name of the parameter in a file of ranges.
        said: String,
        /// What is wrong with it, and what was expected.
        message: String,
    },
    /// The experiment cannot be used.
    #[error(transparent)]
    Config(#[from] crate::config::ConfigError),
    /// A part of the rig makes no sense.
    #[error(transparent)]
    Experiment(#[from] crate::experiment::ExperimentError),
    /// A trial could not be recorded.
    #[error(transparent)]
    Record(#[from] feeler_record::RecordError),
    /// The policy is another than that with which the sweep was started.
    #[error(
        "control.law.policy.file = {file:?}: the policy has the SHA-256 {actual}; expected {expected}, with \
         which the sweep was started"
    )]
    Policy {
        /// The policy's file, as the experiment names it.
        file: String,
        /// SHA-256 of the policy that the sweep was started with.
        expected: String,
        /// SHA-256 of what the file holds.
        actual: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}; {note}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// What became of the sweep.
        note: String,
    },
    /// A folder does not hold what it should.
    #[error("{}: {message}", path.display())]
    Folder {
        /// The folder or file.
        path: PathBuf,
        /// What is wrong, and what was expected.
        message: String,
    },
}
