//! Errors of schedules.

/// Error returned when a schedule cannot be created.
#[derive(Debug, thiserror::Error)]
pub enum PaceError {
    /// The period is outside of the range that a system timer supports.
    #[error("expected a control period between 1e-6 and 3600 s, got {period} s")]
    Period {
        /// The rejected period (s).
        period: f64,
    },
    /// The histogram of lateness could not be created.
    #[error("failed to create the histogram of lateness: {0}")]
    Histogram(#[from] hdrhistogram::CreationError),
}

impl PaceError {
    /// Checks a period (s).
    pub(super) fn check_period(period: f64) -> Result<(), Self> {
        match (1e-6..=3600.0).contains(&period) {
            true => Ok(()),
            false => Err(Self::Period { period }),
        }
    }
}
