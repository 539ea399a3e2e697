//! Rows of text: comma-separated values, or lines of JSON.

use super::output::RowWriter;
use super::whole_rows::WholeRows;
use feeler_console::CommandError;
use serde::Serialize;
use std::io::{self, Write};

/// Where rows are written to, in either form.
pub enum RowFile {
    /// Comma-separated values.
    Csv(Box<csv::Writer<WholeRows<RowWriter>>>),
    /// Lines of JSON.
    JsonLines(WholeRows<RowWriter>),
}

impl RowFile {
    /// A table with these columns.
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

    /// A line for each row.
    pub fn json_lines(writer: RowWriter) -> Self {
        Self::JsonLines(WholeRows::new(writer))
    }

    /// Writes a row whose fields have the names of the columns.
    pub fn write(&mut self, row: &impl Serialize) -> Result<(), CommandError> {
        self.write_either(row, row)
    }

    /// Writes a row: `cells`, the values of the columns in their order, or `object`, in which they have names.
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

    /// Hands on all whole rows.
    pub fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Csv(writer) => writer.flush(),
            Self::JsonLines(writer) => writer.flush(),
        }
    }
}
