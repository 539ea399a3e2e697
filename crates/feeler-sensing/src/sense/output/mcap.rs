//! Messages of ROS 2 in an MCAP file.

use super::{FrameReadings, OfPictures, Output};
use feeler::sensor::frame::Frame;
use feeler::sensor::sensing::ElementReading;
use feeler_console::CommandError;
use feeler_record::sensed::{MOMENTS, TACTILE};
use feeler_record::wire::Vector3;
use feeler_record::{Image, MessageSink, Moments, SensedWriter, Tactile, topics};
use glam::{DVec2, DVec3};
use std::path::{Path, PathBuf};

/// The pictures of a sensor on their way into an MCAP file; none where they are not kept.
pub struct Pictures(Option<(usize, Image)>);

impl Pictures {
    /// Those of `finger`, if one is named.
    pub fn of(finger: Option<usize>) -> Self {
        Self(finger.map(|finger| (finger, Image::of_finger(finger))))
    }

    /// Writes the picture of `frame`.
    pub fn write(&mut self, frame: &Frame, writer: &mut SensedWriter) -> Result<(), CommandError> {
        if let Some((finger, image)) = &mut self.0 {
            image.fill(frame)?;
            writer.write(topics::image(*finger), image)?;
        }
        Ok(())
    }
}

/// ROS 2 messages in an MCAP file: moments and, calibrated, forces; pictures where they are kept.
pub struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
    forces: bool,
}

impl Mcap {
    /// A file at `path`.
    pub fn create(path: &Path, format: &OfPictures) -> Result<Self, CommandError> {
        Ok(Self {
            writer: SensedWriter::create(path, format.pictures)?,
            pictures: Pictures::of(format.pictures),
            forces: format.forces,
        })
    }
}

/// What a frame says before any calibration.
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

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.writer.write(MOMENTS, &moments(frame))?;
        let &FrameReadings {
            sequence,
            stamp,
            readings,
            ..
        } = frame;
        if self.forces {
            // A force that there is not is not a number in each component.
            let force = |r: &ElementReading| Vector3::from(r.force.unwrap_or(DVec3::NAN));
            self.writer.write(
                TACTILE,
                &Tactile {
                    sequence,
                    stamp,
                    forces: readings.iter().map(force).collect(),
                },
            )?;
        }
        Ok(())
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        self.pictures.write(frame, &mut self.writer)
    }

    /// Not for every frame: each time costs 0.6 KB.
    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(())
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        Ok(self.writer.flush()?)
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        Ok(self.writer.finish().map(|()| None)?)
    }
}
