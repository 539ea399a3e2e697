//! What can go wrong with an export.

use feeler::sensor::camera::CameraError;
use feeler_record::RecordError;
use parquet::errors::ParquetError;
use std::path::{Path, PathBuf};

/// Why a recording could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordError),
    /// A file or folder could not be made or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A Parquet file could not be written.
    #[error("Parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// A run does not fit into the format, or not to the runs before it.
    #[error("{run}: {what}: {expected} expected, {actual} found")]
    Run {
        /// Name of the run.
        run: String,
        /// What of it.
        what: String,
        /// What was expected.
        expected: String,
        /// What arrived.
        actual: String,
    },
    /// A picture of a run could not be read.
    #[error("{run}: {source}")]
    Picture {
        /// Name of the run.
        run: String,
        /// What was expected and what found.
        source: CameraError,
    },
    /// A video could not be encoded or written.
    #[error("{run}: {key}: {reason}")]
    Video {
        /// Name of the run.
        run: String,
        /// The feature that its pictures are.
        key: String,
        /// What the encoder or the system said.
        reason: String,
    },
    /// It was ended from outside.
    #[error("interrupted")]
    Interrupted,
}

impl ExportError {
    /// What the system said of the file at `path`.
    pub(crate) fn of_file(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        |source| Self::File { path, source }
    }

    /// Something of `run` that does not fit.
    pub(crate) fn of_run(
        run: &str,
        what: impl Into<String>,
        expected: impl Into<String>,
        actual: impl Into<String>,
    ) -> Self {
        Self::Run {
            run: run.into(),
            what: what.into(),
            expected: expected.into(),
            actual: actual.into(),
        }
    }
}
