//! Tables of measured values.

use crate::league::definition::Target;
use feeler::sensor::table::{Quantity, Table};
use feeler_console::{CommandError, open_table};
use std::io::{BufReader, Cursor, Read};
use std::path::Path;

/// Rows of a table of measured values.
#[derive(Debug, Default)]
pub struct Measured {
    /// Value of the key column of each row.
    pub keys: Vec<String>,
    /// Targets of each row; NaN if not measured.
    pub values: Vec<Vec<f64>>,
    /// Number of rows that could not be read.
    pub skipped: usize,
}

/// Reads the columns of `targets` and the column `key` from the table at `path`. `without_header` contains the names of
/// all columns if the table has no header.
///
/// # Errors
/// If the table cannot be read or a column is missing.
pub fn read_targets(
    path: &Path,
    key: &str,
    targets: &[Target],
    without_header: Option<&[String]>,
) -> Result<Measured, CommandError> {
    let refused = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let stream = open_table(path).map_err(|e| refused(&e))?;
    let header = without_header.map(|names| names.join(",") + "\n");
    let header = Cursor::new(header.unwrap_or_default());
    let mut table = Table::open(BufReader::new(header.chain(stream))).map_err(|e| refused(&e))?;
    let missing = |name: &str, table: &Table<_>| {
        let header = table.header().shown();
        refused(&format_args!("no column {name:?}; columns found: {header}"))
    };
    let found = table.column(key).map_err(|e| refused(&e))?;
    let key = found.ok_or_else(|| missing(key, &table))?;
    let mut columns = Vec::new();
    for target in targets {
        let column = table.number_column(&target.column, Quantity::Any);
        let column = column.map_err(|e| refused(&e))?;
        columns.push(column.ok_or_else(|| missing(&target.column, &table))?);
    }
    let mut measured = Measured::default();
    loop {
        match table.advance() {
            Ok(true) => {}
            Ok(false) => return Ok(measured),
            Err(error) if error.affects_one_row() => {
                measured.skipped += 1;
                continue;
            }
            Err(error) => return Err(refused(&error).into()),
        }
        let values = columns.iter().zip(targets).map(|(&column, target)| {
            let number = table.number(column).unwrap_or(f64::NAN);
            match target.at_least {
                Some(least) if number < least => f64::NAN,
                _ if number.is_finite() => target.factor * number,
                _ => f64::NAN,
            }
        });
        measured.values.push(values.collect());
        measured.keys.push(table.text(key).into_owned());
    }
}
