//! Which recordings, or which of their frames, have slip.

use super::CommandError;
use super::notes::Notes;
use std::collections::{BTreeMap, HashMap};
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
        let mut table = Table::open(path)?;
        let name = NAMES.iter().find_map(|name| table.find(name)).unwrap_or(0);
        let slip = table.column(SLIP)?;
        let group = group.map(|group| table.column(group)).transpose()?;
        let frame = table.find(FRAME);
        let mut labels = Self {
            of_frames: frame.is_some(),
            ..Self::default()
        };
        while let Some(row) = table.next(notes) {
            let name = row.cell(name);
            if name.is_empty() {
                notes.add("unnamed", || {
                    row.odd("a label without the name of a recording, left out")
                });
                continue;
            }
            let own_group = group.map_or(name, |group| row.cell(group));
            let known = labels.recordings.entry(name.to_owned());
            let (known_group, label) = known.or_insert_with(|| (own_group.to_owned(), None));
            if own_group != known_group {
                notes.add("groups", || {
                    row.odd(&format!(
                        "{name} is in another group than before, where it stays"
                    ))
                });
            }
            let Some(slip) = row.slip(slip, notes) else {
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
                    let Ok(frame) = row.cell(frame).parse::<usize>() else {
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
    let mut table = Table::open(path)?;
    let slip = table.column(SLIP)?;
    let frame = table.find(FRAME);
    let mut frames = BTreeMap::new();
    let mut number = 0;
    while let Some(row) = table.next(notes) {
        let own = frame.map_or(Ok(number), |frame| row.cell(frame).parse());
        number += 1;
        let Ok(own) = own else {
            notes.add("frame", || {
                row.odd("a frame that is no number from 0, left out")
            });
            continue;
        };
        if let Some(slip) = row.slip(slip, notes) {
            frames.insert(own, slip);
        }
    }
    Ok(Label::Frames(frames))
}

/// A table of labels.
struct Table {
    name: String,
    header: Vec<String>,
    rows: csv::StringRecordsIntoIter<std::io::BufReader<Box<dyn std::io::Read + Send>>>,
}

impl Table {
    fn open(path: &Path) -> Result<Self, CommandError> {
        let name = path.display().to_string();
        let refused =
            |what: &str| format!("{name}: {what}; expected a table with a column {SLIP:?}");
        let stream = crate::table_file::open(path).map_err(|e| refused(&e.to_string()))?;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(stream);
        let header = reader.headers().map_err(|e| refused(&e.to_string()))?;
        let header = header.iter();
        let header = header
            .map(|h| h.trim_start_matches('\u{feff}').to_owned())
            .collect();
        Ok(Self {
            name,
            header,
            rows: reader.into_records(),
        })
    }

    fn find(&self, column: &str) -> Option<usize> {
        self.header.iter().position(|name| name == column)
    }

    fn column(&self, column: &str) -> Result<usize, CommandError> {
        self.find(column).ok_or_else(|| {
            let header = self.header.join(",");
            format!(
                "{}: no column {column:?}; expected one beside {header}",
                self.name
            )
            .into()
        })
    }

    /// The next row that can be read.
    fn next(&mut self, notes: &mut Notes) -> Option<Row> {
        loop {
            let record = self.rows.next()?;
            let line = self.rows.reader().position().line();
            match record {
                Ok(cells) if cells.iter().all(str::is_empty) => {}
                Ok(cells) => {
                    let line = cells.position().map_or(line, csv::Position::line);
                    let name = self.name.clone();
                    return Some(Row { name, line, cells });
                }
                Err(error) => {
                    notes.add("row", || {
                        format!("{}: {error}; the row is left out", self.name)
                    });
                    // A stream that fails goes on failing.
                    if error.is_io_error() {
                        return None;
                    }
                }
            }
        }
    }
}

struct Row {
    name: String,
    line: u64,
    cells: csv::StringRecord,
}

impl Row {
    fn cell(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or("")
    }

    fn odd(&self, what: &str) -> String {
        format!("{}, line {}: {what}", self.name, self.line)
    }

    /// The label, if there is one.
    fn slip(&self, column: usize, notes: &mut Notes) -> Option<bool> {
        let cell = self.cell(column);
        match cell.parse::<f64>() {
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
