//! The wrench in each frame: a table, lines of JSON, or MCAP.

use super::output::{Format, FrameReadings, Output, Pictures, RowWriter, moments};
use super::row_file::RowFile;
use feeler::sensor::frame::Frame;
use feeler::sensor::wrench::{WrenchAxis, WrenchEstimate, WrenchEstimator};
use feeler_console::CommandError;
use feeler_record::ros::{Header, Time, Wrench, WrenchStamped};
use feeler_record::sensed::{MOMENTS, WRENCH};
use feeler_record::wire::Vector3;
use feeler_record::{MessageSink, SensedWriter};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Name of the frame in which a wrench was measured.
const FRAME: &str = "wrench_sensor";

/// The wrench that the estimator predicts of what pictures say.
pub struct OfWrench {
    pub estimator: WrenchEstimator,
    /// The finger whose pictures are kept, if they are.
    pub pictures: Option<usize>,
}

impl OfWrench {
    fn into(&self, sink: Box<dyn Sink>) -> Box<dyn Output> {
        Box::new(Estimated {
            estimator: self.estimator.clone(),
            sink,
            frames: 0,
            invalid: 0,
        })
    }
}

impl Format for OfWrench {
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

/// Something that wrenches are written to.
trait Sink: Send {
    fn write(
        &mut self,
        frame: &FrameReadings,
        estimate: &WrenchEstimate,
    ) -> Result<(), CommandError>;

    /// Writes the picture of a frame, where pictures are kept.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }

    /// Hands on what was collected, where that costs no room.
    fn flush(&mut self) -> Result<(), CommandError>;

    /// Hands on everything that was collected.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }

    fn finish(self: Box<Self>) -> Result<(), CommandError>;
}

/// Predicts wrenches and hands them on.
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
            format!("{invalid} of {frames} frames are unlike those of the calibration; their wrench is not valid")
        })
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        self.sink.finish().map(|()| None)
    }
}

/// The wrench in one frame, as it is written; what there is not is left empty.
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

/// ROS 2 messages in an MCAP file: moments and wrenches; pictures where they are kept.
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
        // What there is not, or is not valid, is not a number.
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

    /// Not for every frame: each time costs 0.6 KB.
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
