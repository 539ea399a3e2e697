//! Writes the wrench of each frame as a table, JSON Lines, or MCAP.

use super::output::{Format, FrameReadings, Output, Pictures, RowFile, RowWriter, moments};
use feeler::sensor::image::Frame;
use feeler::sensor::wrench::{WrenchAxis, WrenchEstimate, WrenchEstimator};
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
        let axes = WrenchAxis::ALL.map(WrenchAxis::name);
        let columns = ["frame", "stamp"].into_iter().chain(axes);
        let file = RowFile::csv(writer, columns.chain(["valid", "novelty"]))?;
        let estimates = Estimates::new(&self.estimator);
        Ok(Box::new(Rows { file, estimates }))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let estimates = Estimates::new(&self.estimator);
        let file = RowFile::json_lines(writer);
        Ok(Box::new(Rows { file, estimates }))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Mcap {
            writer: SensedWriter::create_for_wrenches(path, self.pictures)?,
            pictures: Pictures::of(self.pictures),
            estimates: Estimates::new(&self.estimator),
        }))
    }
}

/// Predicts the wrench of each frame and counts invalid ones.
struct Estimates {
    estimator: WrenchEstimator,
    frames: u64,
    invalid: u64,
}

impl Estimates {
    fn new(estimator: &WrenchEstimator) -> Self {
        Self {
            estimator: estimator.clone(),
            frames: 0,
            invalid: 0,
        }
    }

    fn next(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        let estimate = self.estimator.estimate(frame.readings);
        self.frames += 1;
        self.invalid += u64::from(!estimate.valid);
        estimate
    }

    fn warning(&self) -> Option<String> {
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
    valid: bool,
    novelty: Option<f64>,
}

impl Row {
    fn new(frame: &FrameReadings, estimate: &WrenchEstimate) -> Self {
        let [f_x, f_y, f_z, m_x, m_y, m_z] = estimate.components;
        Self {
            frame: frame.sequence,
            stamp: frame.stamp,
            f_x,
            f_y,
            f_z,
            m_x,
            m_y,
            m_z,
            valid: estimate.valid,
            novelty: Some(estimate.novelty).filter(|novelty| novelty.is_finite()),
        }
    }
}

/// Writer of one row per frame.
struct Rows {
    file: RowFile,
    estimates: Estimates,
}

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        self.file.write(&Row::new(frame, &estimate))
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }

    fn warning(&self) -> Option<String> {
        self.estimates.warning()
    }
}

/// ROS 2 messages in an MCAP file: moments, wrenches and, if recorded, images.
struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
    estimates: Estimates,
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        self.writer.write(MOMENTS, &moments(frame))?;
        // Components that are missing or not valid become NaN.
        let known = |component: Option<f64>| component.filter(|_| estimate.valid);
        let [f_x, f_y, f_z, m_x, m_y, m_z] =
            (estimate.components).map(|component| known(component).unwrap_or(f64::NAN));
        let message = WrenchStamped {
            header: Header {
                stamp: Time::of(frame.stamp).unwrap_or_default(),
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
        };
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
