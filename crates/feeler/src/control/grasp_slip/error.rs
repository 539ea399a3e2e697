//! Why a detector of slip in grasps cannot be set up.

use super::FEWEST_ELEMENTS;
use crate::check::Problem;

/// Why a detector of slip in grasps cannot be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraspSlipError {
    /// There are too few places for a pattern.
    #[error("{actual} elements; expected at least {FEWEST_ELEMENTS} for a regular pattern")]
    TooFew {
        /// Places that are numbers.
        actual: usize,
    },
    /// The places are no grid.
    #[error(
        "no regular pattern: {covered} of {elements} elements can be reached from neighbour to neighbour in equal steps, \
         {agreeing} of {neighbours} pairs of neighbours are one step apart; expected nine of ten"
    )]
    NotAGrid {
        /// Elements that steps lead to.
        covered: usize,
        /// Elements in all.
        elements: usize,
        /// Neighbours by their indices that are a step apart in the picture.
        agreeing: usize,
        /// Neighbours by their indices.
        neighbours: usize,
    },
    /// The places do not tell the lens from the pattern.
    #[error("the pattern has {columns} columns and {rows} rows; expected at least 3 of each")]
    TooNarrow {
        /// Different indices along the first step.
        columns: usize,
        /// Different indices along the second.
        rows: usize,
    },
    /// Values of the configuration are out of range.
    #[error("{}", list(.0))]
    Values(Vec<Problem>),
}

fn list(problems: &[Problem]) -> String {
    let problems: Vec<_> = problems.iter().map(Problem::to_string).collect();
    problems.join("; ")
}
