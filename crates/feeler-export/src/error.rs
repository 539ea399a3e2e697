//! What can go wrong with an export.

use feeler_record::RecordError;
use parquet::errors::ParquetError;

/// Why a recording could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordError),
    /// A Parquet file could not be written.
    #[error("Parquet: {0}")]
    Parquet(#[from] ParquetError),
}
