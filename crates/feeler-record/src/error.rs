//! Errors of recordings.

use crate::wire::WireError;
use ::mcap::McapError;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Errors returned when a recording is written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file could not be created, written or read.
    #[error("recording {path}: {source}")]
    File {
        /// Path of the recording.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The container could not be written.
    #[error("recording {path}: {source}")]
    Mcap {
        /// Path of the recording.
        path: PathBuf,
        /// Error of the MCAP library.
        source: McapError,
    },
    /// The facts of a run are invalid.
    #[error("run facts: {field}: expected {expected}, got {actual}")]
    Facts {
        /// Field of [`RunFacts`](super::RunFacts).
        field: &'static str,
        /// Expected value.
        expected: String,
        /// Actual value.
        actual: String,
    },
    /// A message is for a finger that the run does not have.
    #[error("the recording has {fingers} fingers, but a message is for finger {actual} (from 0)")]
    Finger {
        /// Number of fingers of the run.
        fingers: usize,
        /// Index of the finger in the message.
        actual: usize,
    },
    /// A message belongs to a topic that was not registered when the recording was created.
    #[error("the recording was created without the topic {topic} of a message")]
    NotRegistered {
        /// Topic of the message.
        topic: String,
    },
    /// A stamp is not a valid time of a run.
    #[error("{topic}: expected a stamp of at least 0 s, got {stamp}")]
    Stamp {
        /// Topic of the message.
        topic: String,
        /// Stamp (s).
        stamp: f64,
    },
    /// A message could not be encoded or decoded.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// An earlier write failed and returned its error; nothing more can be written.
    #[error("recording {path}: closed after an earlier error")]
    Closed {
        /// Path of the recording.
        path: PathBuf,
    },
    /// The file accepted no data until the time limit and was left without its end.
    #[error(
        "recording {path}: the file accepted no data for {limit:?}; it has no end record but remains readable up to the last chunk"
    )]
    NotClosed {
        /// Path of the recording.
        path: PathBuf,
        /// Time limit.
        limit: Duration,
    },
    /// The file contains no readable recording.
    #[error("recording {path}: nothing readable: {reason}")]
    NothingReadable {
        /// Path of the file.
        path: PathBuf,
        /// Expected and actual content.
        reason: String,
    },
}

impl RecordError {
    /// Returns a function that adds the file at `path` to an error of the operating system.
    pub(crate) fn file(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::File { path, source }
    }

    /// Converts an error of the MCAP library for the file at `path`. An I/O error becomes [`RecordError::File`].
    pub(super) fn of_mcap(path: &Path, source: McapError) -> Self {
        let path = path.to_path_buf();
        match source {
            McapError::Io(source) => Self::File { path, source },
            source => Self::Mcap { path, source },
        }
    }
}
