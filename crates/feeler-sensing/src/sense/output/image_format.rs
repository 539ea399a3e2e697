//! Readings of images: moments and forces.

use super::format::Format;
use super::frame_output::FrameReadings;
use super::row_file::RowFile;
use feeler::sensor::forces::ElementReading;
use feeler_console::CommandError;
use feeler_record::sensed::{MOMENTS, TACTILE};
use feeler_record::{MessageSink, Moments, SensedWriter, Tactile};
use glam::DVec2;
use serde::Serialize;
use std::path::Path;

/// Output format for images: moments and, if calibrated, forces.
pub struct ImageFormat {
    /// `true` if forces are written.
    pub forces: bool,
    /// Finger whose images are recorded, or `None` if images are not recorded.
    pub pictures: Option<usize>,
}

/// Columns of one element in one frame; missing values are empty.
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
    /// Creates the force columns of a reading.
    pub fn of(reading: &ElementReading) -> Self {
        Self {
            f_x: reading.force.map(|f| f.x),
            f_y: reading.force.map(|f| f.y),
            f_z: reading.force.map(|f| f.z),
        }
    }
}

impl Row {
    fn new(frame: &FrameReadings, element: usize, reading: &ElementReading) -> Self {
        Self {
            frame: frame.sequence,
            stamp: frame.stamp,
            element,
            integrated_gray: Some(reading.integrated_gray).filter(|gray| gray.is_finite()),
            u_x: reading.displacement.map(|u| u.x),
            u_y: reading.displacement.map(|u| u.y),
        }
    }
}

/// A row and its force in one JSON object; the CSV writer cannot flatten structs.
#[derive(Serialize)]
struct JsonRow<'a> {
    #[serde(flatten)]
    row: &'a Row,
    #[serde(flatten)]
    force: &'a ForceRow,
}

/// Converts the readings of a frame to a [`Moments`] message.
pub fn moments(frame: &FrameReadings) -> Moments {
    let &FrameReadings {
        sequence,
        stamp,
        readings,
        ..
    } = frame;
    let along = |place: fn(&ElementReading) -> Option<DVec2>, axis: usize| {
        let readings = readings.iter();
        readings
            .map(|r| place(r).map_or(f64::NAN, |p| p[axis]))
            .collect()
    };
    Moments {
        sequence,
        stamp,
        integrated_gray: readings.iter().map(|r| r.integrated_gray).collect(),
        displacement_x: along(|r| r.displacement, 0),
        displacement_y: along(|r| r.displacement, 1),
        centroid_x: along(|r| r.centroid, 0),
        centroid_y: along(|r| r.centroid, 1),
    }
}

/// Converts the readings of a frame to a [`Tactile`] message. An unknown force is NaN in each component.
pub fn tactile(frame: &FrameReadings) -> Tactile {
    Tactile {
        sequence: frame.sequence,
        stamp: frame.stamp,
        forces: frame.forces().map(Into::into).collect(),
    }
}

impl Format for ImageFormat {
    fn columns(&self) -> Vec<&'static str> {
        let moments = ["frame", "stamp", "element", "integrated_gray", "u_x", "u_y"];
        let forces: &[&str] = match self.forces {
            true => &["f_x", "f_y", "f_z"],
            false => &[],
        };
        moments.iter().chain(forces).copied().collect()
    }

    fn write_rows(
        &mut self,
        frame: &FrameReadings,
        file: &mut RowFile,
    ) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let row = &Row::new(frame, element, reading);
            let force = &ForceRow::of(reading);
            match self.forces {
                true => file.write_either(&(row, force), &JsonRow { row, force })?,
                false => file.write(row)?,
            }
        }
        Ok(())
    }

    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError> {
        Ok(SensedWriter::create(path, self.pictures)?)
    }

    fn recorded_finger(&self) -> Option<usize> {
        self.pictures
    }

    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError> {
        writer.write(MOMENTS, &moments(frame))?;
        if self.forces {
            writer.write(TACTILE, &tactile(frame))?;
        }
        Ok(())
    }
}
