//! Which column of a table is what.

use super::{TaxelError, TaxelLayout, TaxelUnit, TimeUnit};
use crate::sensor::table::{
    Cells, Header, Quantity, TableError, are_units, is_no_unit, without_brackets,
};

/// What a column is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Nothing.
    Other,
    /// The time.
    Time,
    /// The sequence.
    Sequence,
    /// An axis of a taxel: 0 is x, 1 y, 2 z.
    Value { taxel: usize, axis: usize },
}

/// The columns of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Their names.
    pub header: Header,
    /// What each is for.
    pub roles: Vec<Role>,
    /// Unit of the values according to the layout.
    unit: TaxelUnit,
    /// Unit of the time, by the layout.
    time: TimeUnit,
}

impl TaxelLayout {
    /// Names of a taxel's columns x, y and z.
    fn columns_of(&self, taxel: usize) -> [String; 3] {
        let columns = &self.columns;
        let number = (u64::from(columns.first) + taxel as u64).to_string();
        [&columns.x, &columns.y, &columns.z].map(|pattern| {
            let named = pattern.replace("{n}", &number);
            named.replace("{prefix}", &columns.prefix)
        })
    }

    /// The column x of the first taxel.
    pub(super) fn first_column(&self) -> String {
        let [x, ..] = self.columns_of(0);
        x
    }

    /// Number of columns of a table without a header, if the layout names them.
    pub(super) fn count_without_header(&self) -> Option<usize> {
        let named = self.columns.without_header.as_ref()?;
        let repeats = |pattern: &String| match is_of_taxel(pattern) {
            true => self.taxels.len(),
            false => 1,
        };
        Some(named.iter().map(repeats).sum())
    }

    /// Names of the columns of a table without a header.
    pub(super) fn names_without_header(&self) -> Vec<String> {
        let named = self.columns.without_header.as_deref().unwrap_or_default();
        let first = u64::from(self.columns.first);
        let mut names = Vec::new();
        for run in named.chunk_by(|a, b| is_of_taxel(a) == is_of_taxel(b)) {
            let repeats = match is_of_taxel(&run[0]) {
                true => self.taxels.len(),
                false => 1,
            };
            for number in (first..).take(repeats) {
                let name = |pattern: &String| {
                    let name = pattern.replace("{n}", &number.to_string());
                    name.replace("{prefix}", &self.columns.prefix)
                };
                names.extend(run.iter().map(name));
            }
        }
        names
    }
}

/// Whether there is a column of this name for each taxel.
fn is_of_taxel(pattern: &str) -> bool {
    pattern.contains("{n}")
}

impl Columns {
    /// Finds the columns of `layout` in a `header`; that of the time, if the table is `timed` by it.
    ///
    /// # Errors
    /// If a column is missing, there twice, meant for two things, or in another unit.
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

    /// Whether `header` has a column of `layout`, possibly under another prefix.
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

    /// Whether cells below the header are the columns' units.
    ///
    /// # Errors
    /// If one is not that of the layout.
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

    /// Refuses a unit in the table that is not the layout's.
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

    /// Gives the column at `place` the role of the layout's column `name`.
    fn give(&mut self, place: usize, role: Role, name: &str) -> Result<(), TaxelError> {
        let column = &self.header.names()[place];
        if self.roles[place] != Role::Other {
            let column = column.clone();
            return Err(TaxelError::TwoMeanings { column });
        }
        // What looks like a unit in the layout's own name is part of the name.
        if column != name
            && let Some(unit) = self.header.unit(place)
        {
            self.check_unit(place, role, unit)?;
        }
        self.roles[place] = role;
        Ok(())
    }
}

/// Where the first taxel's columns are there with other prefixes: an error that says so.
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
