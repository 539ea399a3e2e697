//! Calibration of one element: the map from its moments to the force on it.
//!
//! There are two models: `separable`, the paper's, with one curve for each component of the
//! force; and `coupled`, with each component a function of all moments. Both take an element's
//! moments relative to its unloaded ones ([`RelativeMoments`]).

use super::coupled::CoupledMap;
use super::error::CalibrationError;
use super::quality::ElementQuality;
use super::relative_moments::RelativeMoments;
use super::separable::SeparableMap;
use crate::sensor::moments::kernel::ElementMoments;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Model of the map from moments to forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CalibrationModel {
    /// One curve for each component of the force (paper, section II).
    Separable,
    /// Each component as a function of all moments.
    Coupled,
}

/// Map from an element's moments to the force on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceMap {
    /// One curve for each component of the force.
    Separable(SeparableMap),
    /// Each component as a function of all moments.
    Coupled(CoupledMap),
}

impl ForceMap {
    /// Force in the element's frame `E_i`, N. Finite unless an input is NaN.
    pub fn force(&self, inputs: RelativeMoments) -> DVec3 {
        match self {
            Self::Separable(map) => map.force(inputs),
            Self::Coupled(map) => map.force(inputs),
        }
    }

    /// Minimum and maximum of each input among the loads: gray-value growth, displacement along x, displacement along
    /// y.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        match self {
            Self::Separable(map) => map.ranges(),
            Self::Coupled(map) => map.ranges(),
        }
    }

    /// Returns whether `inputs` are within the ranges of the loads, extended by the fraction `margin` at both ends.
    pub(in crate::sensor) fn covers(&self, inputs: RelativeMoments, margin: f64) -> bool {
        let within = |(input, [low, high]): (f64, [f64; 2])| {
            let margin = margin * (high - low);
            (low - margin..=high + margin).contains(&input)
        };
        inputs
            .components()
            .into_iter()
            .zip(self.ranges())
            .all(within)
    }

    /// Model used by the map.
    pub fn model(&self) -> CalibrationModel {
        match self {
            Self::Separable(_) => CalibrationModel::Separable,
            Self::Coupled(_) => CalibrationModel::Coupled,
        }
    }
}

/// Validity of the force computed for one element in one image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceValidity {
    /// The moments are within the range of the loads used for the calibration.
    Calibrated,
    /// The moments exceed the range of the calibration's loads by more than a tenth: the force is extrapolated
    /// linearly. Most saturated and overexposed sub-regions are in this state.
    Extrapolated,
    /// The element is less than half as bright as without load, or its centroid is not finite. The light, the camera or
    /// the element has failed, and the force is meaningless.
    Dark,
}

/// Calibration of one element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementCalibration {
    /// Unloaded integrated gray value, gray levels times m² (or px²).
    pub unloaded_gray: f64,
    /// Unloaded centroid, m (or px), in x, y of `E_i`.
    pub unloaded_centroid: DVec2,
    /// Map from moments to force.
    pub map: ForceMap,
    /// Accuracy of the map.
    pub quality: ElementQuality,
}

impl ElementCalibration {
    /// Computes `moments` relative to the unloaded ones, as inputs of the map.
    pub fn inputs(&self, moments: &ElementMoments) -> RelativeMoments {
        RelativeMoments::relative(moments, self.unloaded_gray, self.unloaded_centroid)
    }

    /// Force at the element in its frame `E_i`, N (sign: see [`TactileFrame`](crate::sensor::forces::reading::TactileFrame)). Finite
    /// for all finite moments. `F_z` is negative if the image is darker than without load.
    pub fn force(&self, moments: &ElementMoments) -> DVec3 {
        self.map.force(self.inputs(moments))
    }

    /// Validity of the force for `moments`.
    pub fn validity(&self, moments: &ElementMoments) -> ForceValidity {
        /// Fraction of a range by which moments may exceed it, to allow for noise.
        const MARGIN: f64 = 0.1;
        let is_lit = moments.integrated_gray > 0.5 * self.unloaded_gray;
        if !(is_lit && moments.centroid.is_finite()) {
            return ForceValidity::Dark;
        }
        if self.map.covers(self.inputs(moments), MARGIN) {
            ForceValidity::Calibrated
        } else {
            ForceValidity::Extrapolated
        }
    }

    /// Largest force that the map gives at the ends of the ranges of growth and displacement, varied one at a time, N.
    pub(super) fn largest_force(&self) -> f64 {
        let [growth, along_x, along_y] = self.map.ranges();
        let grown = growth.map(|growth| (growth, DVec2::ZERO));
        let moved_x = along_x.map(|x| (0.0, x * DVec2::X));
        let moved_y = along_y.map(|y| (0.0, y * DVec2::Y));
        let ends = grown.into_iter().chain(moved_x).chain(moved_y);
        let forces = ends.map(|(growth, displacement)| {
            let inputs = RelativeMoments {
                growth,
                displacement,
            };
            self.map.force(inputs).length()
        });
        forces.fold(0.0, f64::max)
    }

    /// Rejects values that could make a force infinite or NaN.
    pub(super) fn check(&self, element: usize) -> Result<(), CalibrationError> {
        let unusable = |what: String| CalibrationError::Unusable { element, what };
        // A tiny unloaded value would make the growth infinite.
        if !(self.unloaded_gray.is_finite() && self.unloaded_gray > 1e-100) {
            let gray = self.unloaded_gray;
            return Err(unusable(format!(
                "unloaded_gray must be positive, got {gray}"
            )));
        }
        if !self.unloaded_centroid.is_finite() {
            let centroid = self.unloaded_centroid;
            return Err(unusable(format!(
                "unloaded_centroid must be finite, got {centroid}"
            )));
        }
        match &self.map {
            ForceMap::Separable(map) => map.check(),
            ForceMap::Coupled(map) => map.check(),
        }
        .map_err(unusable)
    }
}
