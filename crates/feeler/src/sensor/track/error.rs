//! Why markers cannot be tracked.

use crate::sensor::locate::LocateError;

/// Why markers cannot be tracked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// There are too few markers for a field.
    #[error("at least {expected} markers expected, got {actual}")]
    MarkerCount {
        /// Least number.
        expected: usize,
        /// How many there are.
        actual: usize,
    },
    /// A picture has another size than the layout's.
    #[error("a picture of {}x{} px expected, got {}x{} px in {pixels} values", expected.0, expected.1, actual.0, actual.1)]
    PictureSize {
        /// Columns and rows of the layout's picture, px.
        expected: (usize, usize),
        /// Columns and rows of the picture, px.
        actual: (usize, usize),
        /// Gray values in the picture.
        pixels: usize,
    },
    /// No markers are seen in a picture.
    #[error(transparent)]
    Locate(#[from] LocateError),
}
