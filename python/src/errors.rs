//! Errors of the crates as Python's exceptions, with the same words as the program's.

use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use std::error::Error;
use std::io::{self, ErrorKind};

/// What a caller gave cannot be used: `ValueError`, or `OSError` where a file is the cause.
pub fn refused(error: impl Error + 'static) -> PyErr {
    let words = error.to_string();
    match io_cause(&error) {
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(words),
        Some(_) => PyOSError::new_err(words),
        None => PyValueError::new_err(words),
    }
}

/// Something ended what had begun well: `RuntimeError`, or `OSError` where a file is the cause.
pub fn failed(error: impl Error + 'static) -> PyErr {
    let words = error.to_string();
    match io_cause(&error) {
        Some(_) => PyOSError::new_err(words),
        None => PyRuntimeError::new_err(words),
    }
}

/// What the system said, if it is at the bottom of `error`.
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
