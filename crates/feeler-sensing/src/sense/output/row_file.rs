//! Rows of text: comma-separated values or JSON Lines.

use super::whole_rows::WholeRows;
use feeler_console::CommandError;
use serde::Serialize;
use std::io::{self, Write};

/// Destination of text.
pub type TextWriter = Box<dyn Write + Send>;

/// A writer of rows in one of two formats.
pub struct RowFile {
    writer: Writer,
    /// Name of the current sequence, if rows contain it.
    sequence: Option<String>,
}

enum Writer {
    /// Comma-separated values.
    Csv(Box<csv::Writer<WholeRows<TextWriter>>>),
    /// JSON Lines: one object per row.
    JsonLines(WholeRows<TextWriter>),
}

/// A row and the name of its sequence.
#[derive(Serialize)]
struct Sequenced<'a, T> {
    sequence: &'a str,
    #[serde(flatten)]
    row: &'a T,
}

impl RowFile {
    /// Creates a table with these columns, after a column `sequence` if `sequences` is `true`.
    pub fn csv(
        writer: TextWriter,
        columns: &[&str],
        sequences: bool,
    ) -> Result<Self, CommandError> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(false)
            .from_writer(WholeRows::new(writer));
        let sequence = sequences.then_some("sequence");
        writer.write_record(sequence.iter().chain(columns))?;
        Ok(Self {
            writer: Writer::Csv(Box::new(writer)),
            sequence: sequences.then(String::new),
        })
    }

    /// Creates a JSON Lines writer. Rows contain the name of their sequence if `sequences` is `true`.
    pub fn json_lines(writer: TextWriter, sequences: bool) -> Self {
        Self {
            writer: Writer::JsonLines(WholeRows::new(writer)),
            sequence: sequences.then(String::new),
        }
    }

    /// Starts a new sequence with this name.
    pub fn begin_sequence(&mut self, name: &str) {
        if let Some(sequence) = &mut self.sequence {
            name.clone_into(sequence);
        }
    }

    /// Writes a row whose fields have the names of the columns.
    pub fn write(&mut self, row: &impl Serialize) -> Result<(), CommandError> {
        self.write_either(row, row)
    }

    /// Writes a row as `cells` (column values in order) to a table, or as `object` (named fields) to JSON Lines.
    pub fn write_either(
        &mut self,
        cells: &impl Serialize,
        object: &impl Serialize,
    ) -> Result<(), CommandError> {
        match (&mut self.writer, &self.sequence) {
            (Writer::Csv(writer), None) => writer.serialize(cells)?,
            (Writer::Csv(writer), Some(sequence)) => writer.serialize((sequence, cells))?,
            (Writer::JsonLines(writer), None) => write_json(writer, object)?,
            (Writer::JsonLines(writer), Some(sequence)) => {
                let row = object;
                write_json(writer, &Sequenced { sequence, row })?;
            }
        }
        Ok(())
    }

    /// Writes all complete rows to the underlying writer.
    pub fn flush(&mut self) -> io::Result<()> {
        match &mut self.writer {
            Writer::Csv(writer) => writer.flush(),
            Writer::JsonLines(writer) => writer.flush(),
        }
    }
}

/// Writes `object` as one line.
fn write_json(
    writer: &mut WholeRows<TextWriter>,
    object: &impl Serialize,
) -> Result<(), CommandError> {
    serde_json::to_writer(&mut *writer, object)?;
    Ok(writer.write_all(b"\n")?)
}
