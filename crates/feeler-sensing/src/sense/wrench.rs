//! Writes the wrench of each frame as a table, JSON Lines, or MCAP.

use super::output::{Format, FrameReadings, RowFile, moments};
use feeler::sensor::wrench::taxels::TaxelWrenchEstimator;
use feeler::sensor::wrench::{AXES, WrenchAxis, WrenchEstimate, WrenchEstimator};
use feeler_console::CommandError;
use feeler_record::ros::{Header, Time, Wrench, WrenchStamped};
use feeler_record::sensed::{MOMENTS, WRENCH};
use feeler_record::wire::Vector3;
use feeler_record::{MessageSink, SensedWriter};
use serde::Serialize;
use std::path::Path;

/// Name of the coordinate frame in which wrenches are given.
const FRAME: &str = "wrench_sensor";

/// Wrench estimator for the readings of a frame.
pub trait Estimate: Send {
    /// Estimates the wrench of `frame`.
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate;

    /// Starts a new sequence, which begins without load.
    fn restart(&mut self) {}
}

impl Estimate for WrenchEstimator {
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        self.estimate(frame.readings)
    }
}

impl Estimate for TaxelWrenchEstimator {
    fn of(&mut self, frame: &FrameReadings) -> WrenchEstimate {
        let values: Vec<_> = frame.forces().collect();
        self.estimate(frame.stamp, &values)
    }

    fn restart(&mut self) {
        Self::restart(self);
    }
}

/// Estimates the wrench of each frame and counts invalid ones.
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

    /// Starts a new sequence, which begins without load.
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

/// Columns of the wrench in one frame; missing values are empty.
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

/// Names of the columns.
pub fn columns() -> Vec<&'static str> {
    let axes = WrenchAxis::ALL.map(WrenchAxis::name);
    let columns = ["frame", "stamp"].into_iter().chain(axes);
    columns.chain(["valid", "novelty"]).collect()
}

/// Writes the wrench of a frame as a row.
pub fn write_row(
    frame: &FrameReadings,
    estimate: &WrenchEstimate,
    file: &mut RowFile,
) -> Result<(), CommandError> {
    file.write(&Row::new(frame, estimate))
}

/// Creates the message with the wrench of a frame at `stamp` (s). Components that are missing or invalid are NaN.
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

/// Output format for the wrenches of images. MCAP files also contain moments and, if recorded, images.
pub struct WrenchFormat {
    pub estimates: Estimates<WrenchEstimator>,
    /// Finger whose images are recorded, or `None` if images are not recorded.
    pub pictures: Option<usize>,
}

impl Format for WrenchFormat {
    fn columns(&self) -> Vec<&'static str> {
        columns()
    }

    fn write_rows(
        &mut self,
        frame: &FrameReadings,
        file: &mut RowFile,
    ) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        write_row(frame, &estimate, file)
    }

    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError> {
        Ok(SensedWriter::create_for_wrenches(path, self.pictures)?)
    }

    fn recorded_finger(&self) -> Option<usize> {
        self.pictures
    }

    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError> {
        let estimate = self.estimates.next(frame);
        writer.write(MOMENTS, &moments(frame))?;
        Ok(writer.write(WRENCH, &message(frame.stamp, &estimate))?)
    }

    fn warning(&self) -> Option<String> {
        self.estimates.warning()
    }
}
