//! The error type of exports.

use feeler::sensor::image::CameraError;
use feeler_record::RecordError;
use parquet::errors::ParquetError;
use std::path::{Path, PathBuf};

/// Error that aborts an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordError),
    /// A file or folder could not be created or written.
    #[error("{path}: {source}")]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Underlying I/O error.
        source: std::io::Error,
    },
    /// A Parquet file could not be written.
    #[error("Parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// A run cannot be represented in the format, or differs from the runs before it.
    #[error("{run}: {what}: expected {expected}, got {actual}")]
    Run {
        /// Name of the run.
        run: String,
        /// Property of the run that is unsupported or differs.
        what: String,
        /// Expected value.
        expected: String,
        /// Actual value.
        actual: String,
    },
    /// An image of a run could not be read.
    #[error("{run}: {source}")]
    Picture {
        /// Name of the run.
        run: String,
        /// Underlying camera error.
        source: CameraError,
    },
    /// A video could not be encoded or written.
    #[error("{run}: {key}: {reason}")]
    Video {
        /// Name of the run.
        run: String,
        /// Feature key of the camera's images.
        key: String,
        /// Message of the encoder or the operating system.
        reason: String,
    },
    /// The export was interrupted by the caller.
    #[error("interrupted")]
    Interrupted,
}

impl ExportError {
    /// Converts an I/O error at `path`.
    pub(crate) fn of_file(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        |source| Self::File { path, source }
    }

    /// Error for a property of `run` that is unsupported or differs.
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
