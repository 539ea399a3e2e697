//! What can be wrong with a pace that is asked for.

/// Why there is no pace.
#[derive(Debug, thiserror::Error)]
pub enum PaceError {
    /// The period is not one that a system's timer can keep.
    #[error("a control period is between 1e-6 and 3600 s, not {period} s")]
    Period {
        /// The period asked for, s.
        period: f64,
    },
    /// The histogram of lateness could not be made.
    #[error("no histogram of lateness: {0}")]
    Histogram(#[from] hdrhistogram::CreationError),
}
