//! File formats of readings.

use super::filed::FileOutput;
use super::frame_output::Output;
use super::mcap::Mcap;
use super::prompt::MaxAgeFlush;
use super::row_file::{RowFile, RowWriter};
use super::rows::Rows;
use feeler_console::{CommandError, Outputs};
use std::io;
use std::path::Path;

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
        Ok(Box::new(Mcap::create(path, self.pictures, self.forces)?))
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
