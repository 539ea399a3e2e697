//! Errors of reading tables.

use super::lines::MAX_LINE;

/// Error of reading a table or one of its rows.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// Reading the stream failed.
    #[error("failed to read the table: {0}")]
    Read(#[from] std::io::Error),
    /// The table contains no text.
    #[error("the table is empty; expected a header with the names of its columns")]
    Empty,
    /// The file is not text.
    #[error("the file is {what}; expected a table of text: save it as CSV, UTF-8")]
    NotText {
        /// Detected kind of file.
        what: &'static str,
    },
    /// The header contains both semicolons and tabs.
    #[error(
        "line {line}: the header has semicolons and tabs; expected one separator (comma, semicolon or tab), and the others only in quotes"
    )]
    Separators {
        /// Line number, from 1.
        line: u64,
    },
    /// Several columns match a name.
    #[error("columns {} may all be {column}; expected one", list(.names))]
    Several {
        /// Name of the column.
        column: String,
        /// Names of the matching columns.
        names: Vec<String>,
    },
    /// The unit of a column does not fit its quantity.
    #[error("column {column:?} is in {unit:?}; expected {expected}")]
    Unit {
        /// Name of the column in the table.
        column: String,
        /// Unit in the table.
        unit: String,
        /// Supported units.
        expected: &'static str,
    },
    /// The header and the row of units contradict each other.
    #[error(
        "column {column:?} is in {unit:?} according to line {line}; expected the unit in the header"
    )]
    OtherUnit {
        /// Name of the column in the table.
        column: String,
        /// Unit in the row of units.
        unit: String,
        /// Line number of the row of units, from 1.
        line: u64,
    },
    /// The number of cells in a row differs from the header.
    #[error("line {line}: {cells} cells; expected {expected}, as in the header{}", hint(.cells, .expected, .separator))]
    CellCount {
        /// Line number, from 1.
        line: u64,
        /// Number of cells.
        cells: usize,
        /// Number of cells in the header.
        expected: usize,
        /// Separator between cells.
        separator: u8,
    },
    /// A quote is not closed at the end of a line.
    #[error("line {line}: a quote is not closed; expected each row on one line")]
    Quote {
        /// Line number, from 1.
        line: u64,
    },
    /// A line is too long.
    #[error(
        "line {line} is longer than {MAX_LINE} bytes; expected a table of text with one row per line"
    )]
    TooLong {
        /// Line number, from 1.
        line: u64,
    },
}

impl TableError {
    /// Returns `true` if only this row is invalid and the following rows can be read.
    pub fn affects_one_row(&self) -> bool {
        matches!(
            self,
            Self::CellCount { .. } | Self::Quote { .. } | Self::TooLong { .. }
        )
    }
}

fn list(names: &[String]) -> String {
    let names: Vec<_> = names.iter().map(|name| format!("{name:?}")).collect();
    names.join(", ")
}

/// Hint for too many comma-separated cells.
fn hint(cells: &usize, expected: &usize, separator: &u8) -> &'static str {
    match *separator == b',' && cells > expected {
        true => "; if numbers have decimal commas, use a semicolon or a tab between cells",
        false => "",
    }
}
