//! Errors of taxel arrays.

use super::{MAX_LINE, TAXEL_LAYOUT_VERSION};
use crate::check::{Problem, joined};

/// Error of a taxel layout or of reading a taxel array's table.
#[derive(Debug, thiserror::Error)]
pub enum TaxelError {
    /// The text is not a taxel layout.
    #[error("not a taxel layout: {0}")]
    Parse(#[from] toml::de::Error),
    /// The layout cannot be written as TOML.
    #[error("failed to write the taxel layout: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file has an unsupported version.
    #[error("expected taxel layout version {TAXEL_LAYOUT_VERSION}, got {actual}")]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// Values of the layout are out of range.
    #[error("{}", joined(.0))]
    Values(Vec<Problem>),
    /// A column is missing from the header or occurs more than once.
    #[error("expected {expected} column {column:?}, got {actual} in the header {header:?}")]
    Column {
        /// Name of the column.
        column: String,
        /// Expected number of columns, in words.
        expected: &'static str,
        /// Number of matching columns.
        actual: usize,
        /// The actual header.
        header: String,
    },
    /// The unit of a column differs from the layout.
    #[error("column {column:?} is in {unit:?}; expected {expected}, the unit in the layout")]
    Unit {
        /// Name of the column.
        column: String,
        /// Unit in the table.
        unit: String,
        /// Unit in the layout.
        expected: &'static str,
    },
    /// The columns exist only with other prefixes.
    #[error("no column {column:?} in the header; expected another prefix: {}", .prefixes.join(" or "))]
    Prefix {
        /// Name of the missing column.
        column: String,
        /// Prefixes with which the columns exist.
        prefixes: Vec<String>,
    },
    /// The table starts with a row of numbers instead of a header.
    #[error(
        "missing header: line {line} has {cells} numbers; expected a header with {column:?}, or all columns \
         listed in columns.without_header of the layout"
    )]
    NoHeader {
        /// Line number.
        line: u64,
        /// Number of cells.
        cells: usize,
        /// Name of the first column expected by the layout.
        column: String,
    },
    /// The number of columns of a table without a header differs from the layout.
    #[error(
        "expected {expected} columns as in columns.without_header of the layout, got {actual} in line {line} of a table without a header"
    )]
    Unnamed {
        /// Number of columns in the layout.
        expected: usize,
        /// Number of cells in the first row.
        actual: usize,
        /// Line number of the first row.
        line: u64,
    },
    /// No header that matches the layout was found.
    #[error("no header with {column:?} in {lines} lines; the first is {first:?}")]
    HeaderNotFound {
        /// Name of the first column expected by the layout.
        column: String,
        /// Number of lines searched.
        lines: u64,
        /// The first line, truncated.
        first: String,
    },
    /// A line in or before the header is too long.
    #[error("line {line} is longer than {MAX_LINE} bytes; expected a table of text")]
    TooLong {
        /// Line number.
        line: u64,
    },
    /// The layout uses a column for two purposes.
    #[error("column {column:?} is used for two purposes in the layout; expected separate columns")]
    TwoMeanings {
        /// Name of the column.
        column: String,
    },
    /// The rows have no time: the layout has no time column and no rate is known.
    #[error("rows have no time; expected a rate, or columns.time or rate in the layout")]
    NoTime,
    /// The rate of the rows is out of range.
    #[error("expected a rate of 0.001 to 100000 Hz, got {actual} Hz")]
    Rate {
        /// The rate, Hz.
        actual: f64,
    },
    /// Reading the table failed.
    #[error("failed to read the table: {0}")]
    Read(#[from] std::io::Error),
}
