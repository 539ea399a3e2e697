//! Errors of schedules.

/// Error of creating a schedule.
#[derive(Debug, thiserror::Error)]
pub enum PaceError {
    /// The period is outside the range supported by system timers.
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
    /// Checks that a period (s) is in the supported range.
    pub(super) fn check_period(period: f64) -> Result<(), Self> {
        match (1e-6..=3600.0).contains(&period) {
            true => Ok(()),
            false => Err(Self::Period { period }),
        }
    }
}
