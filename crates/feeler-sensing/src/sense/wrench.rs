//! Writes the wrench of each frame as a table, JSON Lines, or MCAP.

use super::output::RowFile;
use super::output::{Format, FrameReadings, Output, Pictures, RowWriter, moments};
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

impl WrenchFormat {
    fn into(&self, sink: Box<dyn Sink>) -> Box<dyn Output> {
        Box::new(Estimated {
            estimator: self.estimator.clone(),
            sink,
            frames: 0,
            invalid: 0,
        })
    }
}

impl Format for WrenchFormat {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let axes = WrenchAxis::ALL.map(WrenchAxis::name);
        let columns = ["frame", "stamp"].into_iter().chain(axes);
        let file = RowFile::csv(writer, columns.chain(["valid", "novelty"]))?;
        Ok(self.into(Box::new(Rows(file))))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(self.into(Box::new(Rows(RowFile::json_lines(writer)))))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        let writer = SensedWriter::create_for_wrenches(path, self.pictures)?;
        let pictures = Pictures::of(self.pictures);
        Ok(self.into(Box::new(Mcap { writer, pictures })))
    }
}

/// A destination for wrenches.
trait Sink: Send {
    fn write(
        &mut self,
        frame: &FrameReadings,
        estimate: &WrenchEstimate,
    ) -> Result<(), CommandError>;

    /// Writes the image of a frame if images are recorded.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }

    /// Writes buffered data to the file, except in formats where frequent writes make the file larger (MCAP).
    fn flush(&mut self) -> Result<(), CommandError>;

    /// Passes all buffered data on.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }

    fn finish(self: Box<Self>) -> Result<(), CommandError>;
}

/// Predicts wrenches and writes them to a sink.
struct Estimated {
    estimator: WrenchEstimator,
    sink: Box<dyn Sink>,
    frames: u64,
    invalid: u64,
}

impl Output for Estimated {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let estimate = self.estimator.estimate(frame.readings);
        self.frames += 1;
        self.invalid += u64::from(!estimate.valid);
        self.sink.write(frame, &estimate)
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        self.sink.write_picture(frame)
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        self.sink.flush()
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        self.sink.settle()
    }

    fn warning(&self) -> Option<String> {
        let Self {
            frames, invalid, ..
        } = self;
        (*invalid > 0).then(|| {
            format!("{invalid} of {frames} frames differ too much from those of the calibration; their wrench is not valid")
        })
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        self.sink.finish().map(|()| None)
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

struct Rows(RowFile);

impl Sink for Rows {
    fn write(
        &mut self,
        frame: &FrameReadings,
        estimate: &WrenchEstimate,
    ) -> Result<(), CommandError> {
        self.0.write(&Row::new(frame, estimate))
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.0.flush()?)
    }

    fn finish(mut self: Box<Self>) -> Result<(), CommandError> {
        self.flush()
    }
}

/// ROS 2 messages in an MCAP file: moments, wrenches and, if recorded, images.
struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
}

impl Sink for Mcap {
    fn write(
        &mut self,
        frame: &FrameReadings,
        estimate: &WrenchEstimate,
    ) -> Result<(), CommandError> {
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

    fn finish(self: Box<Self>) -> Result<(), CommandError> {
        Ok(self.writer.finish()?)
    }
}
