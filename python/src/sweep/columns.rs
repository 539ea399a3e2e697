//! Columns of a sweep's table.

use crate::interrupt::interruptible;
use numpy::IntoPyArray as _;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Columns of integers, which may need 63 bits.
const WHOLE: [&str; 2] = ["trial", "seed"];
/// Columns that always contain text. Other columns contain text if any field is neither a number nor empty.
const WORDS: [&str; 3] = ["outcome", "reason", "found"];
/// Name of the only column of booleans.
const SUCCESS: &str = "success";

/// A partially read column.
enum Column {
    Whole(Vec<i64>),
    Truth(Vec<bool>),
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

/// Returns the columns of the table at `path` by name, as arrays or lists of text.
#[pyfunction]
pub fn read_table(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = interruptible(py, |_| read(&path), |_| Ok(()))?;
    let columns = read.map_err(|error| {
        let words = format!(
            "{}: {error}; expected the table of a finished sweep",
            path.display()
        );
        match error.kind() {
            csv::ErrorKind::Io(io) if io.kind() == ErrorKind::NotFound => {
                PyFileNotFoundError::new_err(words)
            }
            csv::ErrorKind::Io(_) => PyOSError::new_err(words),
            _ => PyValueError::new_err(words),
        }
    })?;
    let table = PyDict::new(py);
    for (name, column) in columns {
        match column {
            Column::Whole(values) => table.set_item(name, values.into_pyarray(py))?,
            Column::Truth(values) => table.set_item(name, values.into_pyarray(py))?,
            Column::Numbers(values) => table.set_item(name, values.into_pyarray(py))?,
            Column::Words(values) => table.set_item(name, values)?,
        }
    }
    Ok(table)
}

/// Reads the columns. The file is read twice, because the type of a column is only known at the end, and text needs far
/// more memory than numbers.
fn read(path: &Path) -> csv::Result<Vec<(String, Column)>> {
    let mut reader = csv::Reader::from_path(path)?;
    let names: Vec<_> = reader.headers()?.iter().map(String::from).collect();
    let mut numeric = vec![true; names.len()];
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record)? {
        for (numeric, field) in numeric.iter_mut().zip(&record) {
            *numeric = *numeric && (field.is_empty() || field.parse::<f64>().is_ok());
        }
    }
    let columns = names.into_iter().zip(numeric);
    let mut columns: Vec<_> = columns
        .map(|(name, numeric)| {
            let column = Column::new(&name, numeric);
            (name, column)
        })
        .collect();
    let mut reader = csv::Reader::from_path(path)?;
    while reader.read_record(&mut record)? {
        for ((_, column), field) in columns.iter_mut().zip(&record) {
            column.push(field);
        }
    }
    Ok(columns)
}

impl Column {
    fn new(name: &str, numeric: bool) -> Self {
        match name {
            name if WORDS.contains(&name) || !numeric => Self::Words(Vec::new()),
            name if WHOLE.contains(&name) => Self::Whole(Vec::new()),
            SUCCESS => Self::Truth(Vec::new()),
            _ => Self::Numbers(Vec::new()),
        }
    }

    /// Adds the field of the next row.
    fn push(&mut self, field: &str) {
        match self {
            // Tables written by a sweep contain both in every row.
            Self::Whole(values) => values.push(field.parse().unwrap_or(-1)),
            Self::Truth(values) => values.push(field == "1"),
            Self::Numbers(values) => values.push(field.parse().unwrap_or(f64::NAN)),
            Self::Words(values) => values.push(field.to_string()),
        }
    }
}
