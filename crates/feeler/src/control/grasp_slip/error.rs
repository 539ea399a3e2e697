//! Errors of the slip detectors for grasps.

use super::FEWEST_ELEMENTS;
use crate::check::{Problem, joined};

/// Error returned when a slip detector for grasps cannot be created.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraspSlipError {
    /// There are too few positions for a pattern.
    #[error("expected at least {FEWEST_ELEMENTS} elements for a regular pattern, got {actual}")]
    TooFew {
        /// Number of valid positions.
        actual: usize,
    },
    /// The positions do not form a grid.
    #[error(
        "not a regular pattern: {covered} of {elements} elements can be reached from neighbour to neighbour in equal steps, \
         {agreeing} of {neighbours} pairs of neighbours are one step apart; expected nine of ten"
    )]
    NotAGrid {
        /// Number of elements that can be reached from neighbour to neighbour in equal steps.
        covered: usize,
        /// Total number of elements.
        elements: usize,
        /// Number of pairs of grid neighbours that are one step apart in the image.
        agreeing: usize,
        /// Number of pairs of grid neighbours.
        neighbours: usize,
    },
    /// The pattern is too small to separate it from lens distortion.
    #[error(
        "expected a pattern of at least 3 columns and 3 rows, got {columns} columns and {rows} rows"
    )]
    TooNarrow {
        /// Number of columns of the pattern: distinct grid indices along its first direction.
        columns: usize,
        /// Number of rows of the pattern: distinct grid indices along its second direction.
        rows: usize,
    },
    /// Values of the configuration or of arguments are out of range.
    #[error("{}", joined(.0))]
    Values(Vec<Problem>),
}
