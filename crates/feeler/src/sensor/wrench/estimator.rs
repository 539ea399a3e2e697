//! The wrench in each frame, on the control path.

use super::calibration::WrenchCalibration;
use super::error::WrenchError;
use super::features::{PER_ELEMENT, standardise, usable};
use super::fit::MOST_MISSING;
use super::{AXES, WrenchAxis};
use crate::sensor::moments::ElementMoments;
use crate::sensor::sensing::{ElementReading, Reference};
use glam::DVec3;

/// The wrench in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrenchEstimate {
    /// Each component in the order of [`WrenchAxis::ALL`], N or N m, in the frame and of the sign of what was measured (see
    /// [`wrench`](super)). None of a component that is not calibrated, and of all where over a tenth of the elements are dark or
    /// saturated.
    pub components: [Option<f64>; AXES],
    /// Whether the picture is like those of the calibration. Where it is not, the components are a guess at a straight line.
    pub valid: bool,
    /// How far the picture is from those of the calibration, as a share of what still counts as valid: up to 1. Infinite where too
    /// little is lit.
    pub novelty: f64,
}

impl WrenchEstimate {
    /// A component, N or N m, if there is one.
    pub fn component(&self, axis: WrenchAxis) -> Option<f64> {
        self.components[axis.index()]
    }

    /// The force, N, if it is wholly calibrated and there is one.
    pub fn force(&self) -> Option<DVec3> {
        let [x, y, z, ..] = self.components;
        Some(DVec3::new(x?, y?, z?))
    }
}

/// From what a picture says of all elements to the wrench on the fingertip. Everything is allocated when it is built.
#[derive(Debug, Clone)]
pub struct WrenchEstimator {
    calibration: WrenchCalibration,
    features: Vec<[f64; PER_ELEMENT]>,
}

impl WrenchEstimator {
    /// Predicts by `calibration`. That it was made for the sensor is for the caller to check
    /// ([`WrenchCalibration::check_made_for`]).
    ///
    /// # Errors
    /// When a number in the calibration cannot be used.
    pub fn new(calibration: WrenchCalibration) -> Result<Self, WrenchError> {
        calibration.check()?;
        Ok(Self {
            features: vec![[f64::NAN; PER_ELEMENT]; calibration.model.elements.len()],
            calibration,
        })
    }

    /// What it predicts by.
    pub fn calibration(&self) -> &WrenchCalibration {
        &self.calibration
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.features.len()
    }

    /// Where the centroids are on the mean over the calibration's pictures.
    pub fn reference(&self) -> Reference {
        let elements = self.calibration.model.elements.iter();
        Reference {
            centroids: elements.map(|e| e.used.then_some(e.centroid)).collect(),
        }
    }

    /// The wrench under which the elements read as they do, one reading for each. Neither allocates nor panics.
    pub fn estimate(&mut self, readings: &[ElementReading]) -> WrenchEstimate {
        self.of_seen(readings.iter().map(usable))
    }

    /// As [`Self::estimate`], of moments; none of an element that is dark or saturated.
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
        if missing > MOST_MISSING {
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
