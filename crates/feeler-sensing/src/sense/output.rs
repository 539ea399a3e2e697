//! Where readings go: a table, lines of JSON, or MCAP.

mod filed;
mod mcap;
mod rows;

pub use self::mcap::{Pictures, moments};
pub use self::rows::ForceRow;

use self::{filed::Filed, mcap::Mcap, rows::Rows};
use super::prompt::Prompt;
use super::row_file::RowFile;
use feeler::sensor::frame::Frame;
use feeler::sensor::sensing::ElementReading;
use feeler::sensor::track::TrackedMarker;
use feeler_console::CommandError;
use feeler_console::Outputs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The readings of one frame.
pub struct FrameReadings<'a> {
    /// Number of the frame, from 0.
    pub sequence: u64,
    /// Time of the frame, s.
    pub stamp: f64,
    /// One for each element.
    pub readings: &'a [ElementReading],
    /// One for each element where markers are tracked.
    pub markers: &'a [TrackedMarker],
}

/// Something that readings are written to.
pub trait Output: Send {
    /// Writes one frame.
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError>;
    /// Writes the picture of a frame, where pictures are kept; before the frame itself.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }
    /// The frames from here on are of another sequence, of this name, and have nothing to do with those before.
    fn begin_sequence(&mut self, _name: &str) -> Result<(), CommandError> {
        Ok(())
    }
    /// Hands on what was collected, where that costs no room.
    fn flush(&mut self) -> Result<(), CommandError>;
    /// Hands on everything that was collected.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }
    /// What is to be said of all that was written, if anything is.
    fn warning(&self) -> Option<String> {
        None
    }
    /// Writes what belongs at the end of what is `whole` or not: the partial file that is left, if one is.
    fn finish(mut self: Box<Self>, _whole: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// What rows are written to.
pub type RowWriter = Box<dyn Write + Send>;

/// What outputs say, and how, in each of the formats.
pub trait Format {
    /// Comma-separated values.
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// Lines of JSON.
    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// An MCAP file.
    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError>;
}

/// What pictures say: moments and, calibrated, forces.
pub struct OfPictures {
    /// Whether there are forces.
    pub forces: bool,
    /// The finger whose pictures are kept, if they are.
    pub pictures: Option<usize>,
}

impl Format for OfPictures {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let moments = ["frame", "stamp", "element", "integrated_gray", "u_x", "u_y"];
        let forces: &[&str] = if self.forces {
            &["f_x", "f_y", "f_z"]
        } else {
            &[]
        };
        let columns = moments.iter().chain(forces).copied();
        Ok(Box::new(Rows {
            file: RowFile::csv(writer, columns)?,
            forces: self.forces,
        }))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Rows {
            file: RowFile::json_lines(writer),
            forces: self.forces,
        }))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Mcap::create(path, self)?))
    }
}

/// The output that `path` names by its extension, one of `outputs`, or a table on standard output.
pub fn open(
    path: Option<&Path>,
    mut outputs: Outputs,
    format: &dyn Format,
) -> Result<Box<dyn Output>, CommandError> {
    let Some(path) = path else {
        let table = format.csv(Box::new(io::stdout()))?;
        return Ok(Box::new(Prompt::new(table)));
    };
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if !["csv", "jsonl", "mcap"].contains(&extension) {
        let path = path.display();
        return Err(
            format!("--output {path}: expected a file ending in .csv, .jsonl or .mcap").into(),
        );
    }
    let part = outputs.create(path, "--output")?;
    let output: Box<dyn Output> = match extension {
        "csv" => format.csv(Box::new(part.writer()?))?,
        "jsonl" => format.jsonl(Box::new(part.writer()?))?,
        _ => format.mcap(part.part())?,
    };
    let name = path.display().to_string();
    let filed = Filed::new(name, output, part, extension != "mcap");
    Ok(Box::new(Prompt::new(Box::new(filed))))
}

/// An error after which a part of the output is left.
pub fn partial(error: &CommandError, part: &Path) -> CommandError {
    format!("{error}; {} is partial", part.display()).into()
}
