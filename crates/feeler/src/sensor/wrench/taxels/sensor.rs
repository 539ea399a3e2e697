//! Tactile sensor of one element, from a taxel array's table and a wrench calibration.

use super::estimator::TaxelWrenchEstimator;
use crate::sensor::forces::reading::{SensorError, TactileFrame, TactileSensor};
use crate::sensor::taxel::TaxelSensor;
use crate::sensor::wrench::sensor::{check_forces, felt_force, only_force};
use crate::sensor::wrench::{WrenchError, WrenchEstimate};
use glam::DMat3;
use std::io::BufRead;

/// A fingertip with a taxel array that measures only the total force. Like
/// [`WrenchSensor`](crate::sensor::wrench::WrenchSensor), but reads the rows of a table instead of images.
#[derive(Debug)]
pub struct TaxelWrenchSensor<R> {
    taxels: TaxelSensor<R>,
    estimator: TaxelWrenchEstimator,
    axes: DMat3,
    values: TactileFrame,
    estimate: Option<WrenchEstimate>,
}

impl<R: BufRead> TaxelWrenchSensor<R> {
    /// Creates a sensor that processes the rows of `taxels` with `estimator`.
    ///
    /// # Errors
    /// If `taxels` and `estimator` have different numbers of elements, or if `f_x`, `f_y` or `f_z` is not calibrated.
    pub fn new(
        taxels: TaxelSensor<R>,
        estimator: TaxelWrenchEstimator,
    ) -> Result<Self, WrenchError> {
        let count = taxels.element_count();
        check_forces(estimator.calibration(), count)?;
        Ok(Self {
            taxels,
            estimator,
            axes: DMat3::IDENTITY,
            values: TactileFrame::unloaded(count),
            estimate: None,
        })
    }

    /// Sets the matrix that converts a calibrated force to the force on the fingertip, in a frame whose z axis points
    /// outward along the dome's axis: a rotation, multiplied by -1 if the force on the object was measured.
    #[must_use]
    pub fn with_axes(self, axes: DMat3) -> Self {
        Self { axes, ..self }
    }

    /// Wrench of the latest reading in the calibrated frame; `None` before the first reading.
    pub fn estimate(&self) -> Option<&WrenchEstimate> {
        self.estimate.as_ref()
    }
}

impl<R: BufRead> TactileSensor for TaxelWrenchSensor<R> {
    fn element_count(&self) -> usize {
        1
    }

    /// Reads the next row; blocks until it is available. Neither allocates nor panics.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let force = only_force(&mut reading.forces)?;
        self.taxels.read(&mut self.values)?;
        if self.taxels.starts_sequence() {
            self.estimator.restart();
        }
        let TactileFrame {
            sequence,
            stamp,
            forces,
        } = &self.values;
        let estimate = self.estimator.estimate(*stamp, forces);
        *force = felt_force(&estimate, self.axes);
        self.estimate = Some(estimate);
        (reading.sequence, reading.stamp) = (*sequence, *stamp);
        Ok(())
    }
}
