//! Errors of a vector environment.

use super::EnvironmentError;

/// Maximum number of environments, and of threads.
const MOST: usize = 1 << 17;

/// Error in the setup or a step of a vector environment.
#[derive(Debug, thiserror::Error)]
pub enum VectorError {
    /// An environment could not be set up, or failed.
    #[error("environment {index}: {source}")]
    Environment {
        /// Index of the environment.
        index: usize,
        /// Error of this environment.
        source: Box<EnvironmentError>,
    },
    /// An environment panicked. It must be reset.
    #[error("environments {first} to {last}: the program panicked: {message}")]
    Panicked {
        /// Index of the first environment of the group that was stepped together.
        first: usize,
        /// Index of the last environment of the group.
        last: usize,
        /// Message of the panic.
        message: String,
    },
    /// A number is out of range, or a length is wrong.
    #[error("{what}: expected {expected}, got {actual}")]
    Count {
        /// Name of the quantity.
        what: &'static str,
        /// Expected value.
        expected: String,
        /// Actual value.
        actual: usize,
    },
    /// The system cannot create the threads.
    #[error("{threads} threads: {source}")]
    Threads {
        /// Requested number of threads.
        threads: usize,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Returns a function that wraps an error of environment `index`.
pub(super) fn at(index: usize) -> impl Fn(EnvironmentError) -> VectorError {
    move |source| VectorError::Environment {
        index,
        source: Box::new(source),
    }
}

/// Returns an error about `what` unless `actual` equals `expected`.
pub(super) fn check_count(
    what: &'static str,
    expected: usize,
    actual: usize,
) -> Result<(), VectorError> {
    if actual == expected {
        return Ok(());
    }
    Err(VectorError::Count {
        what,
        expected: expected.to_string(),
        actual,
    })
}

/// Requires a number from 1 to [`MOST`].
pub(super) fn check_range(what: &'static str, actual: usize) -> Result<(), VectorError> {
    if (1..=MOST).contains(&actual) {
        return Ok(());
    }
    Err(VectorError::Count {
        what,
        expected: format!("1 to {MOST}"),
        actual,
    })
}
