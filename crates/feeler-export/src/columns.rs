//! Columns with their units and meanings, made of a recording's steps.

use crate::columnar::{AnyCells, Cells, Column};
use feeler_record::Step;
use serde_json::{Value, json};

/// A column, and what it is.
pub(crate) struct Described {
    /// The column.
    pub column: Column,
    unit: &'static str,
    meaning: &'static str,
}

impl Described {
    /// Its name, and what stands about it in the file.
    pub fn description(&self) -> (String, Value) {
        let description = json!({ "unit": self.unit, "meaning": self.meaning });
        (self.column.name.clone(), description)
    }
}

/// The columns of some steps while they are made.
pub(crate) struct Columns<'s, 'a> {
    steps: &'s [Step<'a>],
    /// What the next names begin with.
    pub prefix: String,
    /// Those that are made.
    pub made: Vec<Described>,
}

impl<'s, 'a> Columns<'s, 'a> {
    /// Of these steps.
    pub fn of(steps: &'s [Step<'a>]) -> Self {
        Self {
            steps,
            prefix: String::new(),
            made: Vec::new(),
        }
    }

    /// Adds a column of cells that there are.
    pub fn add(&mut self, name: &str, unit: &'static str, meaning: &'static str, cells: AnyCells) {
        let name = format!("{}{name}", self.prefix);
        self.made.push(Described {
            column: Column { name, cells },
            unit,
            meaning,
        });
    }

    /// Adds a number of each step.
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

    /// Adds a list of numbers of each step.
    pub fn list(
        &mut self,
        name: &str,
        unit: &'static str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<Vec<f64>>,
    ) {
        let cells = Cells::of_lists(self.steps.iter().map(cell));
        self.add(name, unit, meaning, AnyCells::Double(cells));
    }

    /// Adds a whole number of each step.
    pub fn whole(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&Step<'a>) -> Option<i64>,
    ) {
        let cells = Cells::of_values(self.steps.iter().map(cell));
        self.add(name, "", meaning, AnyCells::Int(cells));
    }

    /// Adds a flag of each step.
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
