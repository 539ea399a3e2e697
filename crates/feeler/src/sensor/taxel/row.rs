//! From a line to the numbers in it.

use super::columns::{Columns, Role, cells, number};
use super::{Place, Trouble, Troubles};
use glam::DVec3;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Largest number that any sensor counts.
const LARGEST: f64 = 1e12;
/// Largest time, s: three thousand years.
const LATEST: f64 = 1e11;

/// What a line says.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    /// The columns x, y, z of each taxel; not a number where one of the three is none.
    pub values: Vec<DVec3>,
    /// The time in its column's unit, where there is one to be read.
    pub time: Option<f64>,
    /// The sequence, where there is one.
    pub sequence: Vec<u8>,
    /// Of all that stands in the taxels' columns, to tell repeated rows; none where the cells are not the columns'.
    pub hash: Option<u64>,
}

impl Cells {
    /// For `taxels` taxels; names of sequences up to `longest` bytes take no memory.
    pub fn new(taxels: usize, longest: usize) -> Self {
        Self {
            values: vec![DVec3::NAN; taxels],
            time: None,
            sequence: Vec::with_capacity(longest),
            hash: None,
        }
    }

    /// Reads line `number` of a table of `columns`. Whether it is a row; what is wrong with it is counted.
    pub fn read(
        &mut self,
        (columns, delimiter): (&Columns, char),
        (line, text): (u64, &[u8]),
        troubles: &mut Troubles,
    ) -> bool {
        self.values.fill(DVec3::NAN);
        (self.time, self.hash) = (None, None);
        self.sequence.clear();
        let place = Place { line, column: None };
        if cells(text, delimiter).count() != columns.roles.len() {
            let is_row = cells(text, delimiter).any(|cell| number(cell).is_some());
            let trouble = match is_row {
                true => Trouble::CellCount,
                false => Trouble::NotARow,
            };
            troubles.count(trouble, place);
            return is_row;
        }
        let mut hasher = DefaultHasher::new();
        for (index, (cell, &role)) in cells(text, delimiter).zip(&columns.roles).enumerate() {
            let column = Some(index);
            let mut count = |trouble| troubles.count(trouble, Place { line, column });
            match role {
                Role::Other => {}
                Role::Sequence if cell.is_empty() => count(Trouble::Empty),
                Role::Sequence => self.sequence.extend_from_slice(cell),
                Role::Time => match number(cell).filter(|time| time.abs() <= LATEST * 1e9) {
                    Some(time) => self.time = Some(time),
                    None => count(Trouble::TimeUnreadable),
                },
                Role::Value { taxel, axis } => {
                    cell.hash(&mut hasher);
                    match value(cell) {
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
}

fn value(cell: &[u8]) -> Result<f64, Trouble> {
    match number(cell) {
        Some(value) if value.abs() <= LARGEST => Ok(value),
        Some(_) => Err(Trouble::NotFinite),
        None if cell.is_empty() => Err(Trouble::Empty),
        None => Err(Trouble::NotANumber),
    }
}

/// Whether a time can be a stamp, s.
pub fn is_time(seconds: f64) -> bool {
    seconds.abs() <= LATEST
}
