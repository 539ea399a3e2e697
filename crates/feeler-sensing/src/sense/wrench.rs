//! Writes the wrench of each frame as a table, JSON Lines, or MCAP.

use super::output::{Format, FrameReadings, Output, Pictures, RowFile, RowWriter, moments};
use feeler::sensor::forces::NO_FORCE;
use feeler::sensor::image::Frame;
use feeler::sensor::wrench::taxels::TaxelWrenchEstimator;
use feeler::sensor::wrench::{AXES, WrenchAxis, WrenchEstimate, WrenchEstimator};
use feeler_console::CommandError;
use feeler_record::ros::{Header, Time, Wrench, WrenchStamped};
use feeler_record::sensed::{MOMENTS, WRENCH};
use feeler_record::wire::Vector3;
use feeler_record::{MessageSink, SensedWriter};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Name of the coordinate frame in which wrenches are given.
const FRAME: &str = "wrench_sensor";

/// Output format for the wrench that the estimator predicts from each image.
pub struct WrenchFormat {
    pub estimator: WrenchEstimator,
    /// Finger whose images are recorded, or `None` if images are not recorded.
    pub pictures: Option<usize>,
}

impl Format for WrenchFormat {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Rows::csv(writer, self.estimator.clone(), None)?))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let file = RowFile::json_lines(writer);
        Ok(Box::new(Rows::new(file, self.estimator.clone(), None)))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Mcap {
            writer: SensedWriter::create_for_wrenches(path, self.pictures)?,
            pictures: Pictures::of(self.pictures),
            estimates: Estimates::new(self.estimator.clone()),
        }))
    }
}

/// Estimates the wrench from the readings of a frame.
pub trait Estimate: Send {
    /// Estimates the wrench of `frame`.
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate;

    /// Starts a sequence without load.
    fn restart(&mut self) {}
}

impl Estimate for WrenchEstimator {
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        self.estimate(frame.readings)
    }
}

impl Estimate for TaxelWrenchEstimator {
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        let values = frame.readings.iter();
        let values: Vec<_> = values.map(|r| r.force.unwrap_or(NO_FORCE)).collect();
        self.estimate(frame.stamp, &values)
    }

    fn restart(&mut self) {
        Self::restart(self);
    }
}

/// Predicts the wrench of each frame and counts invalid ones.
pub struct Estimates<E> {
    estimator: E,
    frames: u64,
    invalid: u64,
}

impl<E: Estimate> Estimates<E> {
    pub fn new(estimator: E) -> Self {
        Self {
            estimator,
            frames: 0,
            invalid: 0,
        }
    }

    /// Estimates the wrench of the next frame.
    pub fn next(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        let estimate = self.estimator.of(frame);
        self.frames += 1;
        self.invalid += u64::from(!estimate.valid);
        estimate
    }

    /// Starts a sequence without load.
    pub fn restart(&mut self) {
        self.estimator.restart();
    }

    /// Warning about invalid frames, or `None` if all are valid.
    pub fn warning(&self) -> Option<String> {
        let Self {
            frames, invalid, ..
        } = self;
        (*invalid > 0).then(|| {
            format!("{invalid} of {frames} frames differ too much from those of the calibration; their wrench is not valid")
        })
    }
}

/// The wrench of one frame as written; missing values are empty.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    f_x: Option<f64>,
    f_y: Option<f64>,
    f_z: Option<f64>,
    m_x: Option<f64>,
    m_y: Option<f64>,
    m_z: Option<f64>,
    p_x: Option<f64>,
    p_y: Option<f64>,
    valid: bool,
    novelty: Option<f64>,
}

impl Row {
    fn new(frame: &FrameReadings, estimate: &WrenchEstimate) -> Self {
        let [f_x, f_y, f_z, m_x, m_y, m_z, p_x, p_y] = estimate.components;
        Self {
            frame: frame.sequence,
            stamp: frame.stamp,
            f_x,
            f_y,
            f_z,
            m_x,
            m_y,
            m_z,
            p_x,
            p_y,
            valid: estimate.valid,
            novelty: Some(estimate.novelty).filter(|novelty| novelty.is_finite()),
        }
    }
}

/// A row of a table with sequences.
#[derive(Serialize)]
struct SequenceRow<'a> {
    sequence: &'a str,
    #[serde(flatten)]
    row: &'a Row,
}

/// Writer of one row per frame.
pub struct Rows<E> {
    file: RowFile,
    estimates: Estimates<E>,
    /// Name of the current sequence, if a column names sequences.
    sequence: Option<String>,
}

impl<E: Estimate> Rows<E> {
    /// Creates a comma-separated table; with a column for sequences if `sequence` is given.
    pub fn csv(
        writer: RowWriter,
        estimator: E,
        sequence: Option<String>,
    ) -> Result<Self, CommandError> {
        let axes = WrenchAxis::ALL.map(WrenchAxis::name);
        let first = sequence.is_some().then_some("sequence");
        let columns = first.into_iter().chain(["frame", "stamp"]).chain(axes);
        let file = RowFile::csv(writer, columns.chain(["valid", "novelty"]))?;
        Ok(Self::new(file, estimator, sequence))
    }

    /// Creates a writer of rows to `file`.
    pub fn new(file: RowFile, estimator: E, sequence: Option<String>) -> Self {
        Self {
            file,
            estimates: Estimates::new(estimator),
            sequence,
        }
    }
}

impl<E: Estimate> Output for Rows<E> {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        let row = &Row::new(frame, &estimate);
        match &self.sequence {
            Some(sequence) => {
                let object = SequenceRow { sequence, row };
                self.file.write_either(&(sequence, row), &object)
            }
            None => self.file.write(row),
        }
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.sequence = Some(name.to_owned());
        self.estimates.restart();
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }

    fn warning(&self) -> Option<String> {
        self.estimates.warning()
    }
}

/// Message with the wrench of a frame at `stamp` (s). Components that are missing or not valid are NaN.
pub fn message(stamp: f64, estimate: &WrenchEstimate) -> WrenchStamped {
    let known = |component: Option<f64>| component.filter(|_| estimate.valid);
    let components: [f64; AXES] =
        (estimate.components).map(|component| known(component).unwrap_or(f64::NAN));
    let [f_x, f_y, f_z, m_x, m_y, m_z, ..] = components;
    WrenchStamped {
        header: Header {
            stamp: Time::of(stamp).unwrap_or_default(),
            ..Header::of(FRAME)
        },
        wrench: Wrench {
            force: Vector3 {
                x: f_x,
                y: f_y,
                z: f_z,
            },
            torque: Vector3 {
                x: m_x,
                y: m_y,
                z: m_z,
            },
        },
    }
}

/// ROS 2 messages in an MCAP file: moments, wrenches and, if recorded, images.
struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
    estimates: Estimates<WrenchEstimator>,
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        self.writer.write(MOMENTS, &moments(frame))?;
        let message = message(frame.stamp, &estimate);
        Ok(self.writer.write(WRENCH, &message)?)
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

    fn warning(&self) -> Option<String> {
        self.estimates.warning()
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        Ok(self.writer.finish().map(|()| None)?)
    }
}
