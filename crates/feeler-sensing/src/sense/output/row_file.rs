//! Rows of text: comma-separated values or JSON Lines.

use super::whole_rows::WholeRows;
use feeler_console::CommandError;
use serde::Serialize;
use std::io::{self, Write};

/// A writer of rows.
pub type RowWriter = Box<dyn Write + Send>;

/// A writer of rows in one of two formats.
pub enum RowFile {
    /// Comma-separated values.
    Csv(Box<csv::Writer<WholeRows<RowWriter>>>),
    /// JSON Lines: one object per row.
    JsonLines(WholeRows<RowWriter>),
}

impl RowFile {
    /// Creates a table with these columns.
    pub fn csv<'a>(
        writer: RowWriter,
        columns: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, CommandError> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(false)
            .from_writer(WholeRows::new(writer));
        writer.write_record(columns)?;
        Ok(Self::Csv(Box::new(writer)))
    }

    /// Creates a JSON Lines writer.
    pub fn json_lines(writer: RowWriter) -> Self {
        Self::JsonLines(WholeRows::new(writer))
    }

    /// Writes a row whose fields are named like the columns.
    pub fn write(&mut self, row: &impl Serialize) -> Result<(), CommandError> {
        self.write_either(row, row)
    }

    /// Writes a row as `cells` (column values in order) to a table, or as `object` (named fields) to JSON Lines.
    pub fn write_either(
        &mut self,
        cells: &impl Serialize,
        object: &impl Serialize,
    ) -> Result<(), CommandError> {
        match self {
            Self::Csv(writer) => Ok(writer.serialize(cells)?),
            Self::JsonLines(writer) => {
                serde_json::to_writer(&mut *writer, object)?;
                Ok(writer.write_all(b"\n")?)
            }
        }
    }

    /// Passes all complete rows on.
    pub fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Csv(writer) => writer.flush(),
            Self::JsonLines(writer) => writer.flush(),
        }
    }
}
