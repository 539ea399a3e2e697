//! Destinations for readings: a table, JSON Lines, or MCAP.

mod filed;
mod mcap;
mod rows;

pub use self::mcap::{Pictures, moments};
pub use self::rows::ForceRow;

use self::{filed::FileOutput, mcap::Mcap, rows::Rows};
use super::prompt::MaxAgeFlush;
use super::row_file::RowFile;
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::Frame;
use feeler::sensor::track::TrackedMarker;
use feeler_console::{CommandError, Outputs};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Readings of one frame.
pub struct FrameReadings<'a> {
    /// Number of the frame, from 0.
    pub sequence: u64,
    /// Time of the frame (s).
    pub stamp: f64,
    /// One reading per element.
    pub readings: &'a [ElementReading],
    /// One marker per element if markers are tracked, otherwise empty.
    pub markers: &'a [TrackedMarker],
}

/// A destination for readings.
pub trait Output: Send {
    /// Writes one frame.
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError>;
    /// Writes the image of a frame if images are recorded. Called before the frame itself is written.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }
    /// Starts a sequence of this name: later frames are independent of earlier ones.
    fn begin_sequence(&mut self, _name: &str) -> Result<(), CommandError> {
        Ok(())
    }
    /// Writes buffered data to the file, except in formats whose files this would enlarge.
    fn flush(&mut self) -> Result<(), CommandError>;
    /// Writes all buffered data to the file.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }
    /// Returns a warning about the written data, if any.
    fn warning(&self) -> Option<String> {
        None
    }
    /// Writes the end of the output and returns the path of the partial file that remains, if any. If `whole` is
    /// `false`, the output is marked as partial.
    fn finish(mut self: Box<Self>, _whole: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// A writer of rows.
pub type RowWriter = Box<dyn Write + Send>;

/// Kind of output data; creates a writer for each file format.
pub trait Format {
    /// Comma-separated values.
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// JSON Lines.
    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// An MCAP file.
    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError>;
}

/// Output format for images: moments and, if calibrated, forces.
pub struct ImageFormat {
    /// `true` if forces are written.
    pub forces: bool,
    /// Finger whose images are recorded, or `None` if images are not recorded.
    pub pictures: Option<usize>,
}

impl Format for ImageFormat {
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

/// Opens the output whose format is given by the extension of `path`, or a table on standard output if there is no
/// path.
pub fn open(
    path: Option<&Path>,
    mut outputs: Outputs,
    format: &dyn Format,
) -> Result<Box<dyn Output>, CommandError> {
    let Some(path) = path else {
        let table = format.csv(Box::new(io::stdout()))?;
        return Ok(Box::new(MaxAgeFlush::new(table)));
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
    let filed = FileOutput::new(name, output, part, extension != "mcap");
    Ok(Box::new(MaxAgeFlush::new(Box::new(filed))))
}

/// Adds the path of the remaining partial file to an error.
pub fn partial(error: &CommandError, part: &Path) -> CommandError {
    format!("{error}; {} is partial", part.display()).into()
}
