//! Which recordings, or which of their frames, have slip.

use super::notes::Notes;
use feeler::sensor::table::{Header, NumberColumn, Quantity, Table};
use feeler_console::CommandError;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Display;
use std::io::{BufReader, Read};
use std::path::Path;

/// Names of the column that names the recording, where it is not the first.
const NAMES: [&str; 3] = ["recording", "sequence", "video"];
/// The column with the label, and that of the frame.
const SLIP: &str = "slip";
const FRAME: &str = "frame";

/// A recording's label.
#[derive(Debug, Clone, PartialEq)]
pub enum Label {
    /// Of all of it.
    Whole(bool),
    /// Of some of its frames, by their number from 0.
    Frames(BTreeMap<usize, bool>),
}

/// The labels of many recordings.
#[derive(Debug, Default)]
pub struct Labels {
    /// By the recording's name as the table has it: its group, and its label where there is one.
    recordings: HashMap<String, (String, Option<Label>)>,
    /// Whether frames are labelled.
    pub of_frames: bool,
    /// Which labels were asked for.
    used: std::collections::HashSet<String>,
}

impl Labels {
    /// Reads a table of labels; recordings are in groups by the column `group`, or alone.
    ///
    /// # Errors
    /// When it cannot be read, or a column is missing.
    pub fn read(path: &Path, group: Option<&str>, notes: &mut Notes) -> Result<Self, CommandError> {
        let mut table = LabelTable::open(path)?;
        let names = NAMES
            .iter()
            .map(|name| table.find(name))
            .collect::<Result<Vec<_>, _>>()?;
        let name = names.into_iter().flatten().next().unwrap_or(0);
        let group = group.map(|group| table.column(group)).transpose()?;
        let frame = table.find(FRAME)?;
        let mut labels = Self {
            of_frames: frame.is_some(),
            ..Self::default()
        };
        while table.next(notes) {
            let row = &table;
            let name = &*row.cell(name);
            if name.is_empty() {
                notes.add("unnamed", || {
                    row.odd("a label without the name of a recording, left out")
                });
                continue;
            }
            let own_group = group.map_or(name.into(), |group| row.cell(group));
            let known = labels.recordings.entry(name.to_owned());
            let (known_group, label) =
                known.or_insert_with(|| (own_group.clone().into_owned(), None));
            if own_group != *known_group {
                notes.add("groups", || {
                    row.odd(&format!(
                        "{name} is in another group than before, where it stays"
                    ))
                });
            }
            let Some(slip) = row.slip(notes) else {
                continue;
            };
            match (frame, &mut *label) {
                (None, None) => *label = Some(Label::Whole(slip)),
                (None, Some(Label::Whole(before))) if *before == slip => {
                    notes.add("twice", || {
                        row.odd(&format!("{name} is labelled twice, alike"))
                    });
                }
                (None, Some(_)) => {
                    notes.add("both", || {
                        row.odd(&format!(
                            "{name} is labelled twice, differently; the first counts"
                        ))
                    });
                }
                (Some(frame), label) => {
                    let Some(frame) = row.frame(frame) else {
                        notes.add("frame", || {
                            row.odd("a frame that is no number from 0, left out")
                        });
                        continue;
                    };
                    let label = label.get_or_insert_with(|| Label::Frames(BTreeMap::new()));
                    if let Label::Frames(frames) = label
                        && *frames.entry(frame).or_insert(slip) != slip
                    {
                        notes.add("both", || row.odd(&format!("frame {frame} of {name} is labelled twice, differently; the first counts")));
                    }
                }
            }
        }
        Ok(labels)
    }

    /// Group and label of a recording that has one of these names.
    pub fn of(&mut self, names: &[&str]) -> Option<(String, Option<Label>)> {
        let name = names
            .iter()
            .find(|name| self.recordings.contains_key(**name))?;
        self.used.insert((*name).to_owned());
        self.recordings.get(*name).cloned()
    }

    /// Names that no recording had.
    pub fn unused(&self) -> Vec<&str> {
        let names = self
            .recordings
            .keys()
            .filter(|name| !self.used.contains(*name));
        let mut names: Vec<_> = names.map(String::as_str).collect();
        names.sort_unstable();
        names
    }
}

/// Reads the labels of a recording's frames, row by row.
///
/// # Errors
/// When the table cannot be read, or has no column `slip`.
pub fn read_frames(path: &Path, notes: &mut Notes) -> Result<Label, CommandError> {
    let mut table = LabelTable::open(path)?;
    let frame = table.find(FRAME)?;
    let mut frames = BTreeMap::new();
    let mut number = 0;
    while table.next(notes) {
        let row = &table;
        let own = frame.map_or(Some(number), |frame| row.frame(frame));
        number += 1;
        let Some(own) = own else {
            notes.add("frame", || {
                row.odd("a frame that is no number from 0, left out")
            });
            continue;
        };
        if let Some(slip) = row.slip(notes) {
            frames.insert(own, slip);
        }
    }
    Ok(Label::Frames(frames))
}

/// A table of labels.
struct LabelTable {
    name: String,
    table: Table<BufReader<Box<dyn Read + Send>>>,
    slip: NumberColumn,
}

impl LabelTable {
    fn open(path: &Path) -> Result<Self, CommandError> {
        let name = path.display().to_string();
        let refused =
            |what: &dyn Display| format!("{name}: {what}; expected a table with a column {SLIP:?}");
        let stream = feeler_console::open_table(path).map_err(|e| refused(&e))?;
        let mut table = Table::open(stream).map_err(|e| refused(&e))?;
        let slip = table
            .number_column(SLIP, Quantity::Any)
            .map_err(|e| refused(&e))?;
        let slip = slip.ok_or_else(|| no_column(&name, SLIP, table.header()))?;
        Ok(Self { name, table, slip })
    }

    /// The column called `column`, if there is one.
    fn find(&self, column: &str) -> Result<Option<usize>, CommandError> {
        let found = self.table.column(column);
        found.map_err(|e| format!("{}: {e}", self.name).into())
    }

    fn column(&self, column: &str) -> Result<usize, CommandError> {
        let found = self.find(column)?;
        found.ok_or_else(|| no_column(&self.name, column, self.table.header()))
    }

    /// Goes to the next row that can be read, if there is one.
    fn next(&mut self, notes: &mut Notes) -> bool {
        loop {
            match self.table.advance() {
                Ok(there_is) => return there_is,
                Err(error) => {
                    notes.add("row", || {
                        format!("{}: {error}; the row is left out", self.name)
                    });
                    // A stream that fails goes on failing.
                    if !error.is_of_a_row() {
                        return false;
                    }
                }
            }
        }
    }

    fn cell(&self, column: usize) -> Cow<'_, str> {
        self.table.text(column)
    }

    /// The frame in a column, from 0.
    fn frame(&self, column: usize) -> Option<usize> {
        usize::try_from(self.table.whole(column)?).ok()
    }

    fn odd(&self, what: &str) -> String {
        format!("{}, line {}: {what}", self.name, self.table.line())
    }

    /// The row's label, if there is one.
    fn slip(&self, notes: &mut Notes) -> Option<bool> {
        let cell = self.table.number_text(self.slip);
        match self.table.number(self.slip) {
            Ok(0.0) => return Some(false),
            Ok(1.0) => return Some(true),
            _ if cell.is_empty() => notes.add("no label", || self.odd("no label, left out")),
            _ => notes.add("label", || {
                self.odd(&format!("the label {cell:?}, left out; expected 0 or 1"))
            }),
        }
        None
    }
}

fn no_column(table: &str, column: &str, header: &Header) -> CommandError {
    let header = header.shown();
    format!("{table}: no column {column:?}; expected one beside {header}").into()
}
