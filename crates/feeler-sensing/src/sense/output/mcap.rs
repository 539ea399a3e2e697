//! ROS 2 messages in an MCAP file.

use super::frame_output::{FrameReadings, Output};
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::Frame;
use feeler_console::CommandError;
use feeler_record::sensed::{MOMENTS, TACTILE};
use feeler_record::wire::Vector3;
use feeler_record::{Image, MessageSink, Moments, SensedWriter, Tactile, topics};
use glam::{DVec2, DVec3};
use std::path::{Path, PathBuf};

/// Writer of a sensor's images to an MCAP file. Does nothing if images are not recorded.
pub struct Pictures(Option<(usize, Image)>);

impl Pictures {
    /// Creates a writer for the images of `finger`; with `None`, it writes nothing.
    pub fn of(finger: Option<usize>) -> Self {
        Self(finger.map(|finger| (finger, Image::of_finger(finger))))
    }

    /// Writes the image of `frame`.
    pub fn write(&mut self, frame: &Frame, writer: &mut SensedWriter) -> Result<(), CommandError> {
        if let Some((finger, image)) = &mut self.0 {
            image.fill(frame)?;
            writer.write(topics::image(*finger), image)?;
        }
        Ok(())
    }
}

/// ROS 2 messages in an MCAP file: moments, forces if calibrated, and images if recorded.
pub struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
    forces: bool,
}

impl Mcap {
    /// Creates a file at `path`, with the images of the finger `pictures` if given, and with `forces` if `true`.
    pub fn create(
        path: &Path,
        pictures: Option<usize>,
        forces: bool,
    ) -> Result<Self, CommandError> {
        Ok(Self {
            writer: SensedWriter::create(path, pictures)?,
            pictures: Pictures::of(pictures),
            forces,
        })
    }
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
            // A missing force is NaN in each component.
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

    /// Does nothing, because each flush adds 0.6 KB to the file.
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
