//! Estimates the wrench in each frame. Suitable for the control loop.

use super::basis::{Basis, MAX_MISSING};
use super::calibration::CalibrationOf;
use super::error::WrenchError;
use super::moments::{MomentBasis, usable};
use super::{AXES, WrenchAxis};
use crate::sensor::forces::sensing::{ElementReading, Reference};
use crate::sensor::table::Quantity;
use glam::DVec3;

/// Wrench estimated for one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrenchEstimate {
    /// Components in the order of [`WrenchAxis::ALL`] (N, N·m or m), in the frame and with the sign of the measurements
    /// (see [`wrench`](super)). `None` for components that are not calibrated, for the place of contact if nothing is
    /// touched, and for all components if more than a tenth of the elements are dark or saturated.
    pub components: [Option<f64>; AXES],
    /// `true` if the image is similar to those of the calibration. Otherwise the components are extrapolated.
    pub valid: bool,
    /// Novelty distance between the image and those of the calibration; valid up to 1. Infinite if too few elements are
    /// lit.
    pub novelty: f64,
}

impl WrenchEstimate {
    /// Returns a component (N, N·m or m), or `None` if unknown.
    pub fn component(&self, axis: WrenchAxis) -> Option<f64> {
        self.components[axis.index()]
    }

    /// Returns the force, N, or `None` if any of its components is unknown.
    pub fn force(&self) -> Option<DVec3> {
        let [x, y, z, ..] = self.components;
        Some(DVec3::new(x?, y?, z?))
    }
}

/// Estimates the wrench on a camera's fingertip from the moments of all elements.
pub type WrenchEstimator = EstimatorOf<MomentBasis>;

/// Estimates the wrench on a fingertip from the features `B` of all elements. Allocates only during construction.
#[derive(Debug, Clone)]
pub struct EstimatorOf<B: Basis> {
    calibration: CalibrationOf<B>,
    input: B::Input,
    features: Vec<f64>,
}

impl<B: Basis> EstimatorOf<B> {
    /// Creates an estimator. The caller must check that `calibration` was made for the sensor, with
    /// [`CalibrationOf::verify_target`].
    ///
    /// # Errors
    /// If a number in the calibration is invalid.
    pub fn new(calibration: CalibrationOf<B>) -> Result<Self, WrenchError> {
        calibration.check()?;
        Ok(Self {
            features: vec![f64::NAN; calibration.model.elements.feature_count()],
            input: calibration.model.elements.missing_input(),
            calibration,
        })
    }

    /// Calibration in use.
    pub fn calibration(&self) -> &CalibrationOf<B> {
        &self.calibration
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.calibration.made_for.elements
    }

    /// Estimates the wrench from a measurement of all elements, which `fill` writes to its argument. Does not panic;
    /// allocates only if `fill` does.
    pub fn estimate_with(&mut self, fill: impl FnOnce(&mut B::Input)) -> WrenchEstimate {
        fill(&mut self.input);
        let model = &self.calibration.model;
        let missing = model.elements.standardise(&self.input, &mut self.features);
        let mut estimate = WrenchEstimate {
            components: [None; AXES],
            valid: false,
            novelty: f64::INFINITY,
        };
        if missing > MAX_MISSING {
            return estimate;
        }
        let touched = model.elements.reveals_place(&self.input);
        let known = |axis: WrenchAxis| touched || axis.quantity() != Quantity::Length;
        for axis in model.axes.iter().filter(|model| known(model.axis)) {
            let value = axis.value(&model.elements, &self.features);
            estimate.components[axis.axis.index()] = Some(value);
        }
        let distance = model.novelty.distance(&model.elements, &self.features);
        estimate.novelty = distance / model.novelty.limit;
        estimate.valid = estimate.novelty <= 1.0;
        estimate
    }
}

impl EstimatorOf<MomentBasis> {
    /// Reference centroids: the mean centroids over the images of the calibration.
    pub fn reference(&self) -> Reference {
        let elements = self.calibration.model.elements.0.iter();
        Reference {
            centroids: elements.map(|e| e.used.then_some(e.centroid)).collect(),
        }
    }

    /// Estimates the wrench from one reading per element. Neither allocates nor panics.
    pub fn estimate(&mut self, readings: &[ElementReading]) -> WrenchEstimate {
        self.estimate_with(|input| {
            input.fill(None);
            for (moments, reading) in input.iter_mut().zip(readings) {
                *moments = usable(reading);
            }
        })
    }
}
