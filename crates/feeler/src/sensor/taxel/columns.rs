//! Which column of a table is what.

use super::{TaxelError, TaxelLayout};
use std::borrow::Cow;
use std::collections::HashSet;

/// Longest header in an error message, characters.
const SHOWN: usize = 200;

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
    pub names: Vec<String>,
    /// What each is for.
    pub roles: Vec<Role>,
}

/// The cells of a line.
pub fn cells(line: &[u8], delimiter: char) -> impl Iterator<Item = &[u8]> {
    // A layout's delimiter is one byte.
    let delimiter = delimiter as u8;
    line.split(move |&byte| byte == delimiter)
        .filter(move |cell| delimiter != b' ' || !cell.is_empty())
        .map(|cell| {
            let cell = cell.trim_ascii();
            let quoted = cell.strip_prefix(b"\"");
            quoted.and_then(|c| c.strip_suffix(b"\"")).unwrap_or(cell)
        })
}

/// The number in a cell, if there is one.
pub fn number(cell: &[u8]) -> Option<f64> {
    std::str::from_utf8(cell).ok()?.trim().parse().ok()
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
    /// Finds the columns of `layout` among `names`; that of the time, if the table is `timed` by it.
    ///
    /// # Errors
    /// When a column is missing, there twice, or meant for two things.
    pub fn find(layout: &TaxelLayout, names: Vec<String>, timed: bool) -> Result<Self, TaxelError> {
        let mut columns = Self {
            roles: vec![Role::Other; names.len()],
            names,
        };
        for taxel in 0..layout.taxels.len() {
            for (axis, name) in layout.columns_of(taxel).iter().enumerate() {
                let names = &columns.names;
                let missing = |error| other_prefix(names, layout, name).unwrap_or(error);
                let place = columns.place(name).map_err(missing)?;
                columns.give(place, Role::Value { taxel, axis })?;
            }
        }
        if let Some(time) = layout.columns.time.as_ref().filter(|_| timed) {
            let place = columns.place(&time.column)?;
            columns.give(place, Role::Time)?;
        }
        if let Some(sequence) = &layout.columns.sequence {
            let place = columns.place(sequence)?;
            columns.give(place, Role::Sequence)?;
        }
        Ok(columns)
    }

    /// Whether a line of these cells is the header of a table for `layout`: a column of it is there, or would be with
    /// another prefix.
    pub fn is_header(layout: &TaxelLayout, cells: &[String]) -> bool {
        let there: HashSet<&str> = cells.iter().map(String::as_str).collect();
        let named = |name: &String| there.contains(name.as_str());
        let mut taxels = 0..layout.taxels.len();
        taxels.any(|taxel| layout.columns_of(taxel).iter().any(named))
            || other_prefix(cells, layout, &layout.first_column()).is_some()
    }

    fn place(&self, name: &str) -> Result<usize, TaxelError> {
        let mut places = self.names.iter().enumerate().filter(|(_, n)| *n == name);
        match (places.next(), places.count()) {
            (Some((place, _)), 0) => Ok(place),
            (first, others) => Err(TaxelError::Column {
                column: name.to_owned(),
                expected: "one",
                actual: usize::from(first.is_some()) + others,
                header: shortened(&self.names.join(",")).into_owned(),
            }),
        }
    }

    fn give(&mut self, place: usize, role: Role) -> Result<(), TaxelError> {
        if self.roles[place] != Role::Other {
            let column = self.names[place].clone();
            return Err(TaxelError::TwoMeanings { column });
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

/// The first characters of a long text.
pub fn shortened(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}
