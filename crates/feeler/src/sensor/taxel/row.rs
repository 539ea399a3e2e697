//! Parses the cells of a table row.

use super::columns::{Columns, Role};
use super::{TablePosition, TableProblem, TableProblems};
use crate::sensor::table::{Cells, Decimals, NumberError, is_number};
use glam::DVec3;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Maximum magnitude of a valid value.
const LARGEST: f64 = 1e12;
/// Maximum time, s: about three thousand years.
const LATEST: f64 = 1e11;

/// Parsed values of a line.
#[derive(Debug, Clone)]
pub struct Values {
    /// Values in the columns x, y, z of each taxel; NaN if one of the three is invalid.
    pub values: Vec<DVec3>,
    /// Time in the unit of its column, or `None` if missing or invalid.
    pub time: Option<f64>,
    /// Name of the sequence; empty if missing.
    pub sequence: Vec<u8>,
    /// Hash of the cells in the taxels' columns, to detect repeated rows; `None` if the cells do not match the columns.
    pub hash: Option<u64>,
    /// Decimal mark of the table.
    decimals: Decimals,
}

impl Values {
    /// Creates values for `taxels` taxels of a table with this `separator` between cells. Does not allocate later for
    /// names of sequences of up to `longest` bytes.
    pub fn new(taxels: usize, separator: u8, longest: usize) -> Self {
        Self {
            values: vec![DVec3::NAN; taxels],
            time: None,
            sequence: Vec::with_capacity(longest),
            hash: None,
            decimals: Decimals::new(separator),
        }
    }

    /// Parses the `cells` of a `line`, and counts problems. Returns `true` if the line is a row of values.
    pub fn read(
        &mut self,
        columns: &Columns,
        line: u64,
        cells: &Cells,
        problems: &mut TableProblems,
    ) -> bool {
        self.values.fill(DVec3::NAN);
        (self.time, self.hash) = (None, None);
        self.sequence.clear();
        let place = TablePosition { line, column: None };
        if !cells.is_whole() || cells.count() != columns.roles.len() {
            let is_row = cells.iter().any(is_number);
            let problem = match is_row {
                true => TableProblem::CellCount,
                false => TableProblem::NotARow,
            };
            problems.count(problem, place);
            return is_row;
        }
        let numbers = cells.iter().zip(&columns.roles);
        let numbers = numbers.filter(|(_, role)| matches!(role, Role::Time | Role::Value { .. }));
        self.decimals.look(line, numbers.map(|(cell, _)| cell));
        let mut hasher = DefaultHasher::new();
        for (index, (cell, &role)) in cells.iter().zip(&columns.roles).enumerate() {
            let column = Some(index);
            let mut count = |problem| problems.count(problem, TablePosition { line, column });
            match role {
                Role::Other => {}
                Role::Sequence if cell.is_empty() => count(TableProblem::Empty),
                Role::Sequence => self.sequence.extend_from_slice(cell),
                Role::Time => match self.decimals.parse(cell) {
                    Ok(time) if time.abs() <= LATEST * 1e9 => self.time = Some(time),
                    _ => count(TableProblem::TimeUnreadable),
                },
                Role::Value { taxel, axis } => {
                    cell.hash(&mut hasher);
                    match self.value(cell) {
                        Ok(value) => self.values[taxel][axis] = value,
                        Err(problem) => count(problem),
                    }
                }
            }
        }
        self.hash = Some(hasher.finish());
        for value in &mut self.values {
            if value.is_nan() {
                *value = DVec3::NAN;
            }
        }
        true
    }

    fn value(&self, cell: &[u8]) -> Result<f64, TableProblem> {
        match self.decimals.parse(cell) {
            Ok(value) if value.abs() <= LARGEST => Ok(value),
            Ok(_) => Err(TableProblem::NotFinite),
            Err(_) if cell.is_empty() => Err(TableProblem::Empty),
            Err(NumberError::NotANumber) => Err(TableProblem::NotANumber),
            Err(_) => Err(TableProblem::DecimalMark),
        }
    }
}

/// Returns `true` if `seconds` is a valid time.
pub fn is_time(seconds: f64) -> bool {
    seconds.abs() <= LATEST
}
