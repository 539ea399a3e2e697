//! Parses the cells of a line.

use super::columns::{Columns, Role};
use super::{Place, Trouble, Troubles};
use crate::sensor::table::{Cells, Decimals, NumberError, is_number};
use glam::DVec3;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Maximum magnitude of a valid value.
const LARGEST: f64 = 1e12;
/// Maximum time, s: about three thousand years.
const LATEST: f64 = 1e11;

/// Values of a line.
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
    /// Creates values for `taxels` taxels of a table with this `separator` between cells. Names of sequences up to
    /// `longest` bytes do not allocate.
    pub fn new(taxels: usize, separator: u8, longest: usize) -> Self {
        Self {
            values: vec![DVec3::NAN; taxels],
            time: None,
            sequence: Vec::with_capacity(longest),
            hash: None,
            decimals: Decimals::new(separator),
        }
    }

    /// Reads the `cells` of a `line`, and counts problems. Returns `true` if the line is a row.
    pub fn read(
        &mut self,
        columns: &Columns,
        line: u64,
        cells: &Cells,
        troubles: &mut Troubles,
    ) -> bool {
        self.values.fill(DVec3::NAN);
        (self.time, self.hash) = (None, None);
        self.sequence.clear();
        let place = Place { line, column: None };
        if !cells.is_whole() || cells.count() != columns.roles.len() {
            let is_row = cells.iter().any(is_number);
            let trouble = match is_row {
                true => Trouble::CellCount,
                false => Trouble::NotARow,
            };
            troubles.count(trouble, place);
            return is_row;
        }
        let numbers = cells.iter().zip(&columns.roles);
        let numbers = numbers.filter(|(_, role)| matches!(role, Role::Time | Role::Value { .. }));
        self.decimals.look(line, numbers.map(|(cell, _)| cell));
        let mut hasher = DefaultHasher::new();
        for (index, (cell, &role)) in cells.iter().zip(&columns.roles).enumerate() {
            let column = Some(index);
            let mut count = |trouble| troubles.count(trouble, Place { line, column });
            match role {
                Role::Other => {}
                Role::Sequence if cell.is_empty() => count(Trouble::Empty),
                Role::Sequence => self.sequence.extend_from_slice(cell),
                Role::Time => match self.decimals.parse(cell) {
                    Ok(time) if time.abs() <= LATEST * 1e9 => self.time = Some(time),
                    _ => count(Trouble::TimeUnreadable),
                },
                Role::Value { taxel, axis } => {
                    cell.hash(&mut hasher);
                    match self.value(cell) {
                        Ok(value) => self.values[taxel][axis] = value,
                        Err(trouble) => count(trouble),
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

    fn value(&self, cell: &[u8]) -> Result<f64, Trouble> {
        match self.decimals.parse(cell) {
            Ok(value) if value.abs() <= LARGEST => Ok(value),
            Ok(_) => Err(Trouble::NotFinite),
            Err(_) if cell.is_empty() => Err(Trouble::Empty),
            Err(NumberError::NotANumber) => Err(Trouble::NotANumber),
            Err(_) => Err(Trouble::DecimalMark),
        }
    }
}

/// Returns `true` if a time is a valid stamp, s.
pub fn is_time(seconds: f64) -> bool {
    seconds.abs() <= LATEST
}
