//! Why a taxel array cannot be sensed.

use super::{MAX_LINE, TAXEL_LAYOUT_VERSION};
use crate::check::Problem;

/// Why a taxel array cannot be sensed.
#[derive(Debug, thiserror::Error)]
pub enum TaxelError {
    /// The text is no layout.
    #[error("not a taxel layout: {0}")]
    Parse(#[from] toml::de::Error),
    /// The layout cannot be written as text.
    #[error("the taxel layout cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file is of another version.
    #[error("taxel layout version {TAXEL_LAYOUT_VERSION} expected, got {actual}")]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// Values are out of range.
    #[error("{}", list(.0))]
    Values(Vec<Problem>),
    /// A column is not in the header, or there twice.
    #[error("{expected} column {column:?} expected, {actual} in the header {header:?}")]
    Column {
        /// The column.
        column: String,
        /// How many there must be.
        expected: &'static str,
        /// How many there are.
        actual: usize,
        /// The header as it is.
        header: String,
    },
    /// A column is in another unit than the layout says.
    #[error("column {column:?} is in {unit:?}; expected {expected}, the unit in the layout")]
    Unit {
        /// The column.
        column: String,
        /// Its unit.
        unit: String,
        /// The unit that the layout gives.
        expected: &'static str,
    },
    /// The columns are there with other prefixes.
    #[error("no column {column:?} in the header; expected another prefix: {}", .prefixes.join(" or "))]
    Prefix {
        /// The column that is missing.
        column: String,
        /// The prefixes with which there are such columns.
        prefixes: Vec<String>,
    },
    /// The first row is of numbers.
    #[error(
        "there is no header: line {line} has {cells} numbers; expected a header with {column:?}, or all columns \
         in columns.without_header of the layout"
    )]
    NoHeader {
        /// The line.
        line: u64,
        /// Its cells.
        cells: usize,
        /// A column of the layout.
        column: String,
    },
    /// The table has another number of columns than the layout says.
    #[error(
        "columns.without_header has {expected} columns; line {line} of the table has {actual} and no header"
    )]
    Unnamed {
        /// Columns by the layout.
        expected: usize,
        /// Cells of the first row.
        actual: usize,
        /// Its line.
        line: u64,
    },
    /// No line is a header.
    #[error("no header with {column:?} in {lines} lines, the first of them {first:?}")]
    HeaderNotFound {
        /// A column of the layout.
        column: String,
        /// Lines that were read.
        lines: u64,
        /// What stands in the first, up to 80 characters.
        first: String,
    },
    /// A line before or in the header is too long.
    #[error("line {line} is longer than {MAX_LINE} bytes; expected a table of text")]
    TooLong {
        /// The line.
        line: u64,
    },
    /// A column is named for two things.
    #[error("column {column:?} is named for two things in the layout; expected a column for each")]
    TwoMeanings {
        /// The column.
        column: String,
    },
    /// Nothing tells the time.
    #[error(
        "nothing tells the time of a row; expected a rate, or columns.time or rate in the layout"
    )]
    NoTime,
    /// The rate makes no sense.
    #[error("{actual} rows per second; expected 0.001 to 100000 Hz")]
    Rate {
        /// The rate.
        actual: f64,
    },
    /// The table cannot be read.
    #[error("the table cannot be read: {0}")]
    Read(#[from] std::io::Error),
}

fn list(problems: &[Problem]) -> String {
    let problems: Vec<_> = problems.iter().map(Problem::to_string).collect();
    problems.join("; ")
}
