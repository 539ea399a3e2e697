//! What can go wrong with a recording.

use crate::wire::WireError;
use ::mcap::McapError;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why a recording could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file could not be created, written or read.
    #[error("recording {path}: {source}")]
    File {
        /// The recording.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The container could not be written.
    #[error("recording {path}: {source}")]
    Mcap {
        /// The recording.
        path: PathBuf,
        /// What the MCAP library said.
        source: McapError,
    },
    /// A run's facts make no sense.
    #[error("run facts: {field}: {expected} expected, {actual} found")]
    Facts {
        /// Field of [`super::RunFacts`].
        field: &'static str,
        /// What was expected.
        expected: String,
        /// What arrived.
        actual: String,
    },
    /// A message for a finger that the run does not have.
    #[error("the recording is of {fingers} fingers, the message is for finger {actual} (from 0)")]
    Finger {
        /// Fingers of the run.
        fingers: usize,
        /// Finger of the message.
        actual: usize,
    },
    /// A message of a topic that the recording was opened without.
    #[error("the recording was opened without the topic {topic}, a message of it is to be written")]
    NotRegistered {
        /// Topic of the message.
        topic: String,
    },
    /// A stamp that is no time of a run.
    #[error("{topic}: a stamp of 0 s or later expected, {stamp} found")]
    Stamp {
        /// Topic of the message.
        topic: String,
        /// Its stamp, s.
        stamp: f64,
    },
    /// A message could not be put into the wire format.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// An earlier write failed, and said why; nothing more can be written.
    #[error("recording {path}: closed after an earlier error")]
    Closed {
        /// The recording.
        path: PathBuf,
    },
    /// The file took nothing for so long that it was left without its end.
    #[error(
        "recording {path}: the file took nothing for {limit:?}; it is left without its end, readable as far as it goes"
    )]
    NotClosed {
        /// The recording.
        path: PathBuf,
        /// How long it was waited for.
        limit: Duration,
    },
    /// Nothing of the file is of use.
    #[error("recording {path}: nothing readable: {reason}")]
    NothingReadable {
        /// The file.
        path: PathBuf,
        /// What was expected and what was found.
        reason: String,
    },
}

impl RecordError {
    /// What the MCAP library said of the file at `path`; what the system said, if that was it.
    pub(super) fn of_mcap(path: &Path, source: McapError) -> Self {
        let path = path.to_path_buf();
        match source {
            McapError::Io(source) => Self::File { path, source },
            source => Self::Mcap { path, source },
        }
    }
}
