//! Estimates the wrench on a taxel array from each row of readings. Suitable for the control loop.

use super::basis::TaxelBasis;
use super::memory::Memory;
use crate::sensor::wrench::calibration::CalibrationOf;
use crate::sensor::wrench::estimator::EstimatorOf;
use crate::sensor::wrench::{WrenchError, WrenchEstimate};
use glam::DVec3;

/// Estimates the wrench on a taxel array from the readings of all taxels. Allocates only during construction.
#[derive(Debug, Clone)]
pub struct TaxelWrenchEstimator {
    estimator: EstimatorOf<TaxelBasis>,
    memory: Memory,
}

impl TaxelWrenchEstimator {
    /// Creates an estimator. The caller must check that `calibration` was made for the sensor, with
    /// [`CalibrationOf::verify_target`].
    ///
    /// # Errors
    /// If a number in the calibration is invalid.
    pub fn new(calibration: CalibrationOf<TaxelBasis>) -> Result<Self, WrenchError> {
        Ok(Self {
            memory: Memory::new(calibration.made_for.elements),
            estimator: EstimatorOf::new(calibration)?,
        })
    }

    /// Calibration in use.
    pub fn calibration(&self) -> &CalibrationOf<TaxelBasis> {
        self.estimator.calibration()
    }

    /// Starts a new sequence, which begins without load.
    pub fn restart(&mut self) {
        self.memory.restart();
    }

    /// Estimates the wrench from the readings `values` of all taxels at `stamp` (s), in N or counts as in the
    /// calibration; NaN if missing. Neither allocates nor panics.
    pub fn estimate(&mut self, stamp: f64, values: &[DVec3]) -> WrenchEstimate {
        let memory = &mut self.memory;
        self.estimator
            .estimate_with(|input| memory.update(stamp, values, input))
    }
}
