//! Why a table cannot be read.

use super::lines::MAX_LINE;

/// Why a table, or a row of it, cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The stream cannot be read.
    #[error("the table cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// There is no line with text.
    #[error("the table is empty; expected a header with the names of its columns")]
    Empty,
    /// It is not text.
    #[error("it is {what}; expected a table of text: save it as CSV, UTF-8")]
    NotText {
        /// What it is.
        what: &'static str,
    },
    /// The header has two kinds of separators.
    #[error(
        "line {line}: the header has semicolons and tabs; expected a comma, a semicolon or a tab between cells, and the others in quotes"
    )]
    Separators {
        /// The line, from 1.
        line: u64,
    },
    /// A column may be one of several.
    #[error("columns {} may all be {column}; expected one", list(.names))]
    Several {
        /// The column.
        column: String,
        /// Names of those that there are.
        names: Vec<String>,
    },
    /// A column has a unit of something else.
    #[error("column {column:?} is in {unit:?}; expected {expected}")]
    Unit {
        /// The column, as the table has it.
        column: String,
        /// Its unit.
        unit: String,
        /// Units that it may have.
        expected: &'static str,
    },
    /// The header and the row of units give different units.
    #[error(
        "column {column:?} is in {unit:?} by line {line}; expected the unit that the header gives"
    )]
    OtherUnit {
        /// The column, as the table has it.
        column: String,
        /// Its unit in the row of units.
        unit: String,
        /// Line of the units, from 1.
        line: u64,
    },
    /// A row has another number of cells than the header.
    #[error("line {line}: {cells} cells; expected {expected}, as in the header{}", hint(.cells, .expected, .separator))]
    CellCount {
        /// The line, from 1.
        line: u64,
        /// Its cells.
        cells: usize,
        /// Cells of the header.
        expected: usize,
        /// What stands between cells.
        separator: u8,
    },
    /// A quote is open at the end of a line.
    #[error("line {line}: a quote is not closed; expected each row in one line")]
    Quote {
        /// The line, from 1.
        line: u64,
    },
    /// A line is too long.
    #[error(
        "line {line} is longer than {MAX_LINE} bytes; expected a table of text, a row in each line"
    )]
    TooLong {
        /// The line, from 1.
        line: u64,
    },
}

impl TableError {
    /// Whether only this row is wrong, and the next can be read.
    pub fn is_of_a_row(&self) -> bool {
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

/// What to do about too many cells between commas.
fn hint(cells: &usize, expected: &usize, separator: &u8) -> &'static str {
    match *separator == b',' && cells > expected {
        true => "; if numbers have decimal commas, expected a semicolon or a tab between cells",
        false => "",
    }
}
