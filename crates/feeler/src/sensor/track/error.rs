//! Errors of marker tracking.

use crate::sensor::locate::LocateError;

/// Error of tracking markers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// There are too few markers to estimate a displacement field.
    #[error("expected at least {expected} markers, got {actual}")]
    MarkerCount {
        /// Minimum number of markers.
        expected: usize,
        /// Number of markers.
        actual: usize,
    },
    /// The size of an image differs from the layout.
    #[error("expected an image of {}x{} px, got {}x{} px with {pixels} values", expected.0, expected.1, actual.0, actual.1)]
    PictureSize {
        /// Columns and rows according to the layout, px.
        expected: (usize, usize),
        /// Columns and rows of the image, px.
        actual: (usize, usize),
        /// Number of gray values in the image.
        pixels: usize,
    },
    /// No markers were found in an image.
    #[error(transparent)]
    Locate(#[from] LocateError),
}
