//! Assigns roles to the columns of a table.

use super::{TaxelError, TaxelLayout, TaxelUnit, TimeUnit};
use crate::sensor::table::{
    Cells, Header, Quantity, TableError, are_units, is_no_unit, without_brackets,
};

/// Meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Not used.
    Other,
    /// Time of the row.
    Time,
    /// Name of the sequence to which the row belongs.
    Sequence,
    /// Value of a taxel along an axis (0 is x, 1 is y, 2 is z).
    Value { taxel: usize, axis: usize },
}

/// Meaning and units of the columns of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Column names.
    pub header: Header,
    /// Role of each column.
    pub roles: Vec<Role>,
    /// Unit of the values according to the layout.
    unit: TaxelUnit,
    /// Unit of the time according to the layout.
    time: TimeUnit,
}

impl TaxelLayout {
    /// Names of the columns x, y and z of a taxel.
    fn columns_of(&self, taxel: usize) -> [String; 3] {
        let columns = &self.columns;
        let number = u64::from(columns.first) + taxel as u64;
        [&columns.x, &columns.y, &columns.z].map(|pattern| self.column_name(pattern, number))
    }

    /// Column name from a pattern, for the taxel with this `number`.
    fn column_name(&self, pattern: &str, number: u64) -> String {
        let named = pattern.replace("{n}", &number.to_string());
        named.replace("{prefix}", &self.columns.prefix)
    }

    /// Number of columns that match the pattern: one per taxel, or one.
    fn repeats(&self, pattern: &str) -> usize {
        match is_of_taxel(pattern) {
            true => self.taxels.len(),
            false => 1,
        }
    }

    /// Column names of a table: the time column (`time` if the layout has none), then the columns of all taxels.
    pub fn table_header(&self) -> Vec<String> {
        let time = self.columns.time.as_ref();
        let time = time.map_or("time", |time| &time.column).to_owned();
        let taxels = (0..self.taxels.len()).flat_map(|taxel| self.columns_of(taxel));
        std::iter::once(time).chain(taxels).collect()
    }

    /// Name of column x of the first taxel.
    pub(super) fn first_column(&self) -> String {
        let [x, ..] = self.columns_of(0);
        x
    }

    /// Number of columns of a table without a header, or `None` if the layout does not list them.
    pub(super) fn count_without_header(&self) -> Option<usize> {
        let named = self.columns.without_header.as_ref()?;
        Some(named.iter().map(|pattern| self.repeats(pattern)).sum())
    }

    /// Column names of a table without a header.
    pub(super) fn names_without_header(&self) -> Vec<String> {
        let named = self.columns.without_header.as_deref().unwrap_or_default();
        let first = u64::from(self.columns.first);
        let mut names = Vec::new();
        for run in named.chunk_by(|a, b| is_of_taxel(a) == is_of_taxel(b)) {
            for number in (first..).take(self.repeats(&run[0])) {
                let name = |pattern: &String| self.column_name(pattern, number);
                names.extend(run.iter().map(name));
            }
        }
        names
    }
}

/// Returns `true` if the pattern has one column per taxel.
fn is_of_taxel(pattern: &str) -> bool {
    pattern.contains("{n}")
}

impl Columns {
    /// Finds the columns of `layout` in a `header`. Looks for the time column only if `timed`.
    ///
    /// # Errors
    /// If a column is missing, ambiguous, used twice or in a wrong unit.
    pub fn find(layout: &TaxelLayout, header: Header, timed: bool) -> Result<Self, TaxelError> {
        let time = layout.columns.time.as_ref();
        let mut columns = Self {
            roles: vec![Role::Other; header.names().len()],
            header,
            unit: layout.unit,
            time: time.map_or(TimeUnit::S, |time| time.unit),
        };
        for taxel in 0..layout.taxels.len() {
            for (axis, name) in layout.columns_of(taxel).iter().enumerate() {
                let names = columns.header.names();
                let missing = |error| other_prefix(names, layout, name).unwrap_or(error);
                let place = columns.place(name).map_err(missing)?;
                columns.give(place, Role::Value { taxel, axis }, name)?;
            }
        }
        if let Some(time) = time.filter(|_| timed) {
            let place = columns.place(&time.column)?;
            columns.give(place, Role::Time, &time.column)?;
        }
        if let Some(sequence) = &layout.columns.sequence {
            let place = columns.place(sequence)?;
            columns.give(place, Role::Sequence, sequence)?;
        }
        Ok(columns)
    }

    /// Returns `true` if `header` contains a column of `layout`, possibly with a different prefix.
    pub fn is_header(layout: &TaxelLayout, header: &Header) -> bool {
        let named = |name: &String| !matches!(header.find(name), Ok(None));
        let mut taxels = 0..layout.taxels.len();
        taxels.any(|taxel| layout.columns_of(taxel).iter().any(named))
            || other_prefix(header.names(), layout, &layout.first_column()).is_some()
    }

    fn place(&self, name: &str) -> Result<usize, TaxelError> {
        let actual = match self.header.find(name) {
            Ok(Some(place)) => return Ok(place),
            Err(TableError::Several { names, .. }) => names.len(),
            _ => 0,
        };
        Err(TaxelError::Column {
            column: name.to_owned(),
            expected: "one",
            actual,
            header: self.header.shown(),
        })
    }

    /// Returns `true` if the row below the header contains units.
    ///
    /// # Errors
    /// Returns [`TaxelError::Unit`] if a unit differs from the layout.
    pub fn are_units(&self, cells: &Cells) -> Result<bool, TaxelError> {
        let numbers = || {
            let cells = self.roles.iter().zip(cells.iter()).enumerate();
            cells.filter(|(_, (role, _))| matches!(role, Role::Time | Role::Value { .. }))
        };
        let text = |cell| without_brackets(str::from_utf8(cell).unwrap_or("?"));
        if cells.count() != self.roles.len()
            || !are_units(numbers().map(|(_, (_, cell))| text(cell)))
        {
            return Ok(false);
        }
        for (place, (&role, cell)) in numbers() {
            let unit = text(cell);
            if !is_no_unit(unit) {
                self.check_unit(place, role, unit)?;
            }
        }
        Ok(true)
    }

    /// Rejects a unit that differs from the layout.
    fn check_unit(&self, place: usize, role: Role, unit: &str) -> Result<(), TaxelError> {
        let is_same =
            |quantity: Quantity, size| quantity.scale(unit).is_some_and(|scale| scale == size);
        let (fits, expected) = match (role, self.unit) {
            (Role::Time, _) => (
                is_same(Quantity::Time, self.time.seconds()),
                self.time.name(),
            ),
            (Role::Value { .. }, TaxelUnit::Newton) => (is_same(Quantity::Force, 1.0), "N"),
            (Role::Value { .. }, TaxelUnit::Counts) => {
                (Quantity::Force.scale(unit).is_none(), "counts")
            }
            _ => (true, ""),
        };
        match fits {
            true => Ok(()),
            false => Err(TaxelError::Unit {
                column: self.header.names()[place].clone(),
                unit: unit.to_owned(),
                expected,
            }),
        }
    }

    /// Assigns a role to the column with index `place`, named `name` in the layout.
    fn give(&mut self, place: usize, role: Role, name: &str) -> Result<(), TaxelError> {
        let column = &self.header.names()[place];
        if self.roles[place] != Role::Other {
            let column = column.clone();
            return Err(TaxelError::TwoMeanings { column });
        }
        // If the name is exactly the layout's, an apparent unit is part of the name.
        if column != name
            && let Some(unit) = self.header.unit(place)
        {
            self.check_unit(place, role, unit)?;
        }
        self.roles[place] = role;
        Ok(())
    }
}

/// Error that lists the prefixes found, if the table contains the first taxel's columns only with other prefixes than
/// the layout's.
fn other_prefix(names: &[String], layout: &TaxelLayout, missing: &str) -> Option<TaxelError> {
    let pattern = &layout.columns.x;
    let named = pattern.replace("{n}", &layout.columns.first.to_string());
    let (before, after) = named.split_once("{prefix}")?;
    let prefix = |name: &String| {
        let rest = name.strip_prefix(before)?.strip_suffix(after)?;
        let other = !rest.is_empty() && rest != layout.columns.prefix;
        other.then(|| format!("{rest:?}"))
    };
    let prefixes: Vec<_> = names.iter().filter_map(prefix).take(8).collect();
    (!prefixes.is_empty()).then(|| TaxelError::Prefix {
        column: missing.to_owned(),
        prefixes,
    })
}
