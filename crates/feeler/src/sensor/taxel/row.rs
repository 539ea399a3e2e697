//! From a line to the numbers in it.

use super::columns::{Columns, Role};
use super::{Place, Trouble, Troubles};
use crate::sensor::table::{Cells, Decimals, NumberError, is_number};
use glam::DVec3;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Largest number that any sensor counts.
const LARGEST: f64 = 1e12;
/// Largest time, s: three thousand years.
const LATEST: f64 = 1e11;

/// What a line says.
#[derive(Debug, Clone)]
pub struct Values {
    /// The columns x, y, z of each taxel; not a number where one of the three is none.
    pub values: Vec<DVec3>,
    /// The time in its column's unit, where there is one to be read.
    pub time: Option<f64>,
    /// The sequence, where there is one.
    pub sequence: Vec<u8>,
    /// Of all that stands in the taxels' columns, to tell repeated rows; none where the cells are not the columns'.
    pub hash: Option<u64>,
    /// Decimal mark of the table.
    decimals: Decimals,
}

impl Values {
    /// For `taxels` taxels of a table with this `separator` between cells; names of sequences up to `longest` bytes take no memory.
    pub fn new(taxels: usize, separator: u8, longest: usize) -> Self {
        Self {
            values: vec![DVec3::NAN; taxels],
            time: None,
            sequence: Vec::with_capacity(longest),
            hash: None,
            decimals: Decimals::new(separator),
        }
    }

    /// Reads the `cells` of a `line` of a table of `columns`. Whether it is a row; what is wrong with it is counted.
    pub fn read(
        &mut self,
        columns: &Columns,
        (line, cells): (u64, &Cells),
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

/// Whether a time can be a stamp, s.
pub fn is_time(seconds: f64) -> bool {
    seconds.abs() <= LATEST
}
