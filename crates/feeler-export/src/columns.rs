//! Columns with units and descriptions, built from a recording's steps.

use crate::columnar::{AnyCells, Cells, Column};
use feeler_record::Step;
use serde_json::{Value, json};

/// A column with its unit and meaning.
pub(crate) struct Described {
    /// Name and cells of the column.
    pub column: Column,
    unit: &'static str,
    meaning: &'static str,
}

impl Described {
    /// Column name and its entry in the file's metadata.
    pub fn description(&self) -> (String, Value) {
        let description = json!({ "unit": self.unit, "meaning": self.meaning });
        (self.column.name.clone(), description)
    }
}

/// Builder of the columns for a range of steps.
pub(crate) struct Columns<'s, 'a> {
    steps: &'s [Step<'a>],
    /// Prefix of the names of columns added next.
    pub prefix: String,
    /// Columns added so far.
    pub made: Vec<Described>,
}

impl<'s, 'a> Columns<'s, 'a> {
    /// Creates an empty builder for these steps.
    pub fn of(steps: &'s [Step<'a>]) -> Self {
        Self {
            steps,
            prefix: String::new(),
            made: Vec::new(),
        }
    }

    /// Adds a column with the given cells.
    pub fn add(&mut self, name: &str, unit: &'static str, meaning: &'static str, cells: AnyCells) {
        let name = format!("{}{name}", self.prefix);
        self.made.push(Described {
            column: Column { name, cells },
            unit,
            meaning,
        });
    }

    /// Adds a column with one number per step.
    pub fn number(
        &mut self,
        name: &str,
        unit: &'static str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<f64>,
    ) {
        let cells = Cells::of_values(self.steps.iter().map(cell));
        self.add(name, unit, meaning, AnyCells::Double(cells));
    }

    /// Adds a column with one list of numbers per step.
    pub fn list<L>(
        &mut self,
        name: &str,
        unit: &'static str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<L>,
    ) where
        L: IntoIterator<Item = f64, IntoIter: ExactSizeIterator>,
    {
        let cells = Cells::of_lists(self.steps.iter().map(cell));
        self.add(name, unit, meaning, AnyCells::Double(cells));
    }

    /// Adds a column with one integer per step.
    pub fn whole(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<i64>,
    ) {
        let cells = Cells::of_values(self.steps.iter().map(cell));
        self.add(name, "", meaning, AnyCells::Int(cells));
    }

    /// Adds a column with one boolean per step.
    pub fn flag(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<bool>,
    ) {
        let cells = Cells::of_values(self.steps.iter().map(cell));
        self.add(name, "", meaning, AnyCells::Bool(cells));
    }
}
