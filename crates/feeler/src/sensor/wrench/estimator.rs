//! Estimates the wrench in each frame. Suitable for the control loop.

use super::calibration::WrenchCalibration;
use super::error::WrenchError;
use super::features::{MAX_MISSING, PER_ELEMENT, standardise, usable};
use super::{AXES, WrenchAxis};
use crate::sensor::forces::sensing::{ElementReading, Reference};
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;

/// The wrench in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrenchEstimate {
    /// Components in the order of [`WrenchAxis::ALL`], N or N m, in the frame and with the sign of the measurements
    /// (see [`wrench`](super)). `None` for components that are not calibrated, and for all if more than a tenth of the
    /// elements are dark or saturated.
    pub components: [Option<f64>; AXES],
    /// `true` if the image resembles those of the calibration. Otherwise the components are extrapolated.
    pub valid: bool,
    /// Distance of the image from those of the calibration; valid up to 1. Infinite if too few elements are lit.
    pub novelty: f64,
}

impl WrenchEstimate {
    /// Returns a component, N or N m, or `None` if unknown.
    pub fn component(&self, axis: WrenchAxis) -> Option<f64> {
        self.components[axis.index()]
    }

    /// Returns the force, N, or `None` if any of its components is unknown.
    pub fn force(&self) -> Option<DVec3> {
        let [x, y, z, ..] = self.components;
        Some(DVec3::new(x?, y?, z?))
    }
}

/// Estimates the wrench on the fingertip from the moments of all elements. Allocates only during construction.
#[derive(Debug, Clone)]
pub struct WrenchEstimator {
    calibration: WrenchCalibration,
    features: Vec<[f64; PER_ELEMENT]>,
}

impl WrenchEstimator {
    /// Creates an estimator. The caller must check that `calibration` was made for the sensor, with
    /// [`WrenchCalibration::verify_target`].
    ///
    /// # Errors
    /// If a number in the calibration is invalid.
    pub fn new(calibration: WrenchCalibration) -> Result<Self, WrenchError> {
        calibration.check()?;
        Ok(Self {
            features: vec![[f64::NAN; PER_ELEMENT]; calibration.model.elements.len()],
            calibration,
        })
    }

    /// The calibration in use.
    pub fn calibration(&self) -> &WrenchCalibration {
        &self.calibration
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.features.len()
    }

    /// Reference centroids: their means over the images of the calibration.
    pub fn reference(&self) -> Reference {
        let elements = self.calibration.model.elements.iter();
        Reference {
            centroids: elements.map(|e| e.used.then_some(e.centroid)).collect(),
        }
    }

    /// Estimates the wrench from one reading per element. Neither allocates nor panics.
    pub fn estimate(&mut self, readings: &[ElementReading]) -> WrenchEstimate {
        self.of_seen(readings.iter().map(usable))
    }

    /// Like [`Self::estimate`], but from moments: `None` for elements that are dark or saturated.
    pub fn of_seen(
        &mut self,
        seen: impl Iterator<Item = Option<ElementMoments>> + Clone,
    ) -> WrenchEstimate {
        let model = &self.calibration.model;
        let missing = standardise(&model.elements, seen, &mut self.features);
        let mut estimate = WrenchEstimate {
            components: [None; AXES],
            valid: false,
            novelty: f64::INFINITY,
        };
        if missing > MAX_MISSING {
            return estimate;
        }
        for axis in &model.axes {
            estimate.components[axis.axis.index()] = Some(axis.value(&self.features));
        }
        estimate.novelty = model.novelty.distance(&self.features) / model.novelty.limit;
        estimate.valid = estimate.novelty <= 1.0;
        estimate
    }
}
