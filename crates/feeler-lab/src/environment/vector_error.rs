//! Why many environments could not step.

use super::EnvironmentError;

/// Most environments, and most threads.
const MOST: usize = 1 << 17;

/// Why many environments could not step.
#[derive(Debug, thiserror::Error)]
pub enum VectorError {
    /// One of them could not be set up or go on.
    #[error("environment {index}: {source}")]
    Environment {
        /// Which one.
        index: usize,
        /// What it said.
        source: Box<EnvironmentError>,
    },
    /// One of them made the program panic; it needs a reset.
    #[error("environments {first} to {last}: the program panicked: {message}")]
    Panicked {
        /// First of those that were stepped together.
        first: usize,
        /// Last of those.
        last: usize,
        /// What the panic said.
        message: String,
    },
    /// There are too few or too many of something.
    #[error("{what}: {expected} expected, {actual} arrived")]
    Count {
        /// What.
        what: &'static str,
        /// How many there should be.
        expected: String,
        /// How many there are.
        actual: usize,
    },
    /// The system has no more threads.
    #[error("{threads} threads: {source}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        source: std::io::Error,
    },
}

/// What environment `index` said.
pub(super) fn at(index: usize) -> impl Fn(EnvironmentError) -> VectorError {
    move |source| VectorError::Environment {
        index,
        source: Box::new(source),
    }
}

/// Requires `expected` of something.
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

/// Requires some of something, and not far too many.
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
