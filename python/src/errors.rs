//! Conversion of the crates' errors into Python exceptions, with unchanged messages.

use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use std::error::Error;
use std::io::{self, ErrorKind};

/// Converts an error caused by invalid arguments into `ValueError`, or `OSError` if a file caused it.
pub fn refused(error: impl Error + 'static) -> PyErr {
    let words = error.to_string();
    match io_cause(&error) {
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(words),
        Some(_) => PyOSError::new_err(words),
        None => PyValueError::new_err(words),
    }
}

/// Converts a failure during execution into `RuntimeError`, or `OSError` if a file caused it.
pub fn failed(error: impl Error + 'static) -> PyErr {
    let words = error.to_string();
    match io_cause(&error) {
        Some(_) => PyOSError::new_err(words),
        None => PyRuntimeError::new_err(words),
    }
}

/// Kind of the I/O error at the root of `error`, if any.
fn io_cause(error: &(dyn Error + 'static)) -> Option<ErrorKind> {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if let Some(io) = error.downcast_ref::<io::Error>() {
            return Some(io.kind());
        }
        cause = error.source();
    }
    None
}
