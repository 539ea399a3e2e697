//! Rows of a table or of JSON Lines, one per element and frame.

use super::frame_output::{FrameReadings, Output};
use super::row_file::RowFile;
use feeler::sensor::forces::ElementReading;
use feeler_console::CommandError;
use serde::Serialize;

/// One element in one frame as written; missing values are empty.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    element: usize,
    integrated_gray: Option<f64>,
    u_x: Option<f64>,
    u_y: Option<f64>,
}

/// Force columns of a row.
#[derive(Serialize)]
pub struct ForceRow {
    pub f_x: Option<f64>,
    pub f_y: Option<f64>,
    pub f_z: Option<f64>,
}

impl ForceRow {
    /// Creates the columns for the force of a reading.
    pub fn of(reading: &ElementReading) -> Self {
        Self {
            f_x: reading.force.map(|f| f.x),
            f_y: reading.force.map(|f| f.y),
            f_z: reading.force.map(|f| f.z),
        }
    }
}

impl Row {
    fn new(frame: &FrameReadings, element: usize, reading: &ElementReading) -> (Self, ForceRow) {
        let row = Self {
            frame: frame.sequence,
            stamp: frame.stamp,
            element,
            integrated_gray: Some(reading.integrated_gray).filter(|gray| gray.is_finite()),
            u_x: reading.displacement.map(|u| u.x),
            u_y: reading.displacement.map(|u| u.y),
        };
        (row, ForceRow::of(reading))
    }
}

/// Writer of one row per element and frame.
pub struct Rows {
    /// Destination of the rows.
    pub file: RowFile,
    /// `true` if forces are written.
    pub forces: bool,
}

/// A row and its force in one JSON object; the CSV writer cannot flatten structs.
#[derive(Serialize)]
struct JsonRow<'a> {
    #[serde(flatten)]
    row: &'a Row,
    #[serde(flatten)]
    force: &'a ForceRow,
}

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let (row, force) = &Row::new(frame, element, reading);
            match self.forces {
                true => self
                    .file
                    .write_either(&(row, force), &JsonRow { row, force })?,
                false => self.file.write(row)?,
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }
}
