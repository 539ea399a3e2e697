//! Rows of a table, or lines of JSON: one for each element and frame.

use super::{FrameReadings, Output};
use crate::sense::row_file::RowFile;
use feeler::sensor::sensing::ElementReading;
use feeler_console::CommandError;
use serde::Serialize;

/// One element in one frame, as it is written; what there is not is left empty.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    element: usize,
    integrated_gray: Option<f64>,
    u_x: Option<f64>,
    u_y: Option<f64>,
}

/// The force's part of a row.
#[derive(Serialize)]
pub struct ForceRow {
    pub f_x: Option<f64>,
    pub f_y: Option<f64>,
    pub f_z: Option<f64>,
}

impl ForceRow {
    /// That of a reading.
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

/// One row for each element and frame.
pub struct Rows {
    /// Where they are written.
    pub file: RowFile,
    /// Whether there are forces.
    pub forces: bool,
}

/// The fields of a row, which a table cannot flatten.
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
