//! Slip labels of recordings or of their frames.

use super::notes::Notes;
use feeler::sensor::table::{Header, NumberColumn, Quantity, Table};
use feeler_console::CommandError;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Display;
use std::io::{BufReader, Read};
use std::path::Path;

/// Names of the column that identifies the recording; by default the first column.
const NAMES: [&str; 3] = ["recording", "sequence", "video"];
/// Name of the label column.
const SLIP: &str = "slip";
/// Name of the frame column.
const FRAME: &str = "frame";

/// Slip label of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Label {
    /// Label of the whole recording.
    Whole(bool),
    /// Labels of some frames, by frame number from 0.
    Frames(BTreeMap<usize, bool>),
}

/// Labels of many recordings.
#[derive(Debug, Default)]
pub struct Labels {
    /// Group and label, if any, by the name of the recording in the table.
    recordings: HashMap<String, (String, Option<Label>)>,
    /// `true` if frames are labelled, `false` if whole recordings are.
    pub of_frames: bool,
    /// Names of recordings whose labels were used.
    used: std::collections::HashSet<String>,
}

impl Labels {
    /// Reads a table of labels. Recordings are grouped by the column `group`; if `None`, each recording is a group.
    ///
    /// # Errors
    /// If the table cannot be read, or a column is missing.
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
                    row.odd("a label without a recording name; skipped")
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
                        "{name} was in another group before; the first group is used"
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
                        row.odd(&format!("{name} is labelled twice with the same label"))
                    });
                }
                (None, Some(_)) => {
                    notes.add("both", || {
                        row.odd(&format!(
                            "{name} has two different labels; the first is used"
                        ))
                    });
                }
                (Some(frame), label) => {
                    let Some(frame) = row.frame(frame) else {
                        notes.add("frame", || {
                            row.odd("the frame is not a whole number from 0; row skipped")
                        });
                        continue;
                    };
                    let label = label.get_or_insert_with(|| Label::Frames(BTreeMap::new()));
                    if let Label::Frames(frames) = label
                        && *frames.entry(frame).or_insert(slip) != slip
                    {
                        notes.add("both", || row.odd(&format!("frame {frame} of {name} has two different labels; the first is used")));
                    }
                }
            }
        }
        Ok(labels)
    }

    /// Returns the group and label of the recording with one of these names.
    pub fn of(&mut self, names: &[&str]) -> Option<(String, Option<Label>)> {
        let name = names
            .iter()
            .find(|name| self.recordings.contains_key(**name))?;
        self.used.insert((*name).to_owned());
        self.recordings.get(*name).cloned()
    }

    /// Returns the names in the table that match no recording.
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

/// Reads the labels of one recording's frames, row by row.
///
/// # Errors
/// If the table cannot be read, or has no column `slip`.
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
                row.odd("the frame is not a whole number from 0; row skipped")
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

    /// Finds the column named `column`.
    fn find(&self, column: &str) -> Result<Option<usize>, CommandError> {
        let found = self.table.column(column);
        found.map_err(|e| format!("{}: {e}", self.name).into())
    }

    fn column(&self, column: &str) -> Result<usize, CommandError> {
        let found = self.find(column)?;
        found.ok_or_else(|| no_column(&self.name, column, self.table.header()))
    }

    /// Advances to the next readable row and returns `true`, or returns `false` at the end.
    fn next(&mut self, notes: &mut Notes) -> bool {
        loop {
            match self.table.advance() {
                Ok(there_is) => return there_is,
                Err(error) => {
                    notes.add("row", || format!("{}: {error}; row skipped", self.name));
                    // The stream will not recover.
                    if !error.affects_one_row() {
                        return false;
                    }
                }
            }
        }
    }

    fn cell(&self, column: usize) -> Cow<'_, str> {
        self.table.text(column)
    }

    /// Frame number in a column, from 0.
    fn frame(&self, column: usize) -> Option<usize> {
        usize::try_from(self.table.whole(column)?).ok()
    }

    fn odd(&self, what: &str) -> String {
        format!("{}, line {}: {what}", self.name, self.table.line())
    }

    /// Label of the current row, if valid.
    fn slip(&self, notes: &mut Notes) -> Option<bool> {
        let cell = self.table.number_text(self.slip);
        match self.table.number(self.slip) {
            Ok(0.0) => return Some(false),
            Ok(1.0) => return Some(true),
            _ if cell.is_empty() => notes.add("no label", || self.odd("no label; skipped")),
            _ => notes.add("label", || {
                self.odd(&format!("expected a label 0 or 1, got {cell:?}; skipped"))
            }),
        }
        None
    }
}

fn no_column(table: &str, column: &str, header: &Header) -> CommandError {
    let header = header.shown();
    format!("{table}: no column {column:?}; columns found: {header}").into()
}
