//! Calibration of one fingertip: the map from moments to forces, and its file.
//!
//! There are two models: `separable`, the paper's, with one curve for each component of the
//! force; and `coupled`, with each component a function of all moments. Both take an element's
//! moments relative to its unloaded ones ([`RelativeMoments`]). The calibration contains its accuracy ([`ElementQuality`]).

pub use super::coupled::CoupledMap;
pub use super::error::CalibrationError;
use super::load_check::ELEMENT_RANGE;
pub use super::quality::{ElementQuality, FullScale, HeldOutError, explained};
pub use super::separable::{CURVE_TERMS, ForceCurve, SeparableMap};
use super::signs::check_signs;
pub use crate::sensor::fingertip::made_for::{CalibrationTarget, LengthUnit};
use crate::sensor::fingertip::model::FingertipConfig;
use crate::sensor::moments::kernel::ElementMoments;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Version of the calibration file format.
pub const CALIBRATION_VERSION: u32 = 2;

/// An element's moments relative to the unloaded ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RelativeMoments {
    /// Relative growth of the integrated gray value, `G / G_0 - 1`.
    pub growth: f64,
    /// Displacement of the centroid, `c - c_0`, m (or px), in x, y of `E_i`.
    pub displacement: DVec2,
}

impl RelativeMoments {
    /// Computes `moments` relative to the unloaded integrated gray value and centroid.
    pub fn relative(
        moments: &ElementMoments,
        unloaded_gray: f64,
        unloaded_centroid: DVec2,
    ) -> Self {
        Self {
            growth: moments.integrated_gray / unloaded_gray - 1.0,
            displacement: moments.centroid - unloaded_centroid,
        }
    }
}

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
    /// Force in `E_i`, N. Finite unless an input is NaN.
    pub fn force(&self, inputs: RelativeMoments) -> DVec3 {
        match self {
            Self::Separable(map) => map.force(inputs),
            Self::Coupled(map) => map.force(inputs),
        }
    }

    /// Minimum and maximum growth, displacement along x and displacement along y among the loads.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        match self {
            Self::Separable(map) => map.ranges(),
            Self::Coupled(map) => map.ranges(),
        }
    }

    /// Returns whether `inputs` are within the ranges of the loads, extended by the fraction `margin` at both ends.
    pub(in crate::sensor) fn covers(&self, inputs: RelativeMoments, margin: f64) -> bool {
        let RelativeMoments {
            growth,
            displacement,
        } = inputs;
        let inputs = [growth, displacement.x, displacement.y];
        let within = |(input, [low, high]): (f64, [f64; 2])| {
            let margin = margin * (high - low);
            (low - margin..=high + margin).contains(&input)
        };
        inputs.into_iter().zip(self.ranges()).all(within)
    }

    /// Model of the map.
    pub fn model(&self) -> CalibrationModel {
        match self {
            Self::Separable(_) => CalibrationModel::Separable,
            Self::Coupled(_) => CalibrationModel::Coupled,
        }
    }
}

/// Validity of the force at one element in one image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceValidity {
    /// The moments are within the range of the calibration's loads.
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
    /// Unloaded integrated gray value, grey levels times m² (or px²).
    pub unloaded_gray: f64,
    /// Unloaded centroid, m (or px), in x, y of `E_i`.
    pub unloaded_centroid: DVec2,
    /// Map from moments to force.
    pub map: ForceMap,
    /// Accuracy of the map.
    pub quality: ElementQuality,
}

impl ElementCalibration {
    /// Computes `moments` relative to the unloaded ones.
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
        /// Fraction of a range by which noise may exceed it.
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

    /// Largest force at the ends of the ranges of growth and displacement, varied separately, N.
    fn largest_force(&self) -> f64 {
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
    fn check(&self, element: usize) -> Result<(), CalibrationError> {
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

/// Calibration of all elements of one fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the file format, [`CALIBRATION_VERSION`].
    pub version: u32,
    /// Unit of all forces: `"N"`.
    pub force_unit: ForceUnit,
    /// Reference of percentages of full scale.
    pub full_scale: FullScale,
    /// `true` if loads outside the usual range ([`ELEMENT_RANGE`]) were confirmed when the calibration was made.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub loads_confirmed: bool,
    /// The fingertip or layout for which the calibration was made.
    pub made_for: CalibrationTarget,
    /// Calibrations of the elements, in the layout's order.
    pub elements: Vec<ElementCalibration>,
}

/// Unit of forces in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ForceUnit {
    /// Newton.
    #[default]
    #[serde(rename = "N")]
    Newton,
}

/// Reads only the version, to distinguish a file of another version from an invalid one.
#[derive(Deserialize)]
struct VersionOnly {
    version: u32,
}

impl Calibration {
    /// Parses a calibration file.
    ///
    /// # Errors
    /// If the text is not a calibration of this version, or contains an invalid value.
    pub fn from_toml(text: &str) -> Result<Self, CalibrationError> {
        let VersionOnly { version } = toml::from_str(text)?;
        if version != CALIBRATION_VERSION {
            return Err(CalibrationError::Version { actual: version });
        }
        let calibration: Self = toml::from_str(text)?;
        calibration.check()?;
        calibration.check_magnitude()?;
        Ok(calibration)
    }

    /// Formats the calibration as a file.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        Ok(toml::to_string(self)?)
    }

    /// Model of the calibration, taken from its first element.
    pub fn model(&self) -> CalibrationModel {
        let first = self.elements.first();
        first.map_or(CalibrationModel::Separable, |element| element.map.model())
    }

    /// Checks that the calibration was made for `fingertip`.
    ///
    /// # Errors
    /// If the layout, the camera or the configuration of the moments differs.
    pub fn verify_target(&self, fingertip: &FingertipConfig) -> Result<(), CalibrationError> {
        CalibrationTarget::fingertip(fingertip)?.verify_same(&self.made_for)
    }

    /// Rejects invalid values.
    pub(in crate::sensor) fn check(&self) -> Result<(), CalibrationError> {
        self.made_for.check()?;
        let FullScale { normal, shear } = self.full_scale;
        for (key, actual) in [("normal", normal), ("shear", shear)] {
            if !(actual >= 0.0 && actual.is_finite()) {
                return Err(CalibrationError::FullScale { key, actual });
            }
        }
        let expected = self.made_for.elements;
        if self.elements.len() != expected {
            return Err(CalibrationError::ElementCount {
                what: "calibrations",
                expected,
                actual: self.elements.len(),
            });
        }
        self.elements
            .iter()
            .enumerate()
            .try_for_each(|(index, element)| element.check(index))?;
        check_signs(&self.elements)
    }

    /// Checks that the largest forces are plausible for a soft element, to detect loads in another unit. The check is
    /// repeated whenever the file is read.
    ///
    /// # Errors
    /// If full scale or the forces at the ends of the ranges are out of range, and the loads are not
    /// [confirmed](Self::loads_confirmed).
    pub fn check_magnitude(&self) -> Result<(), CalibrationError> {
        /// Factor by which a map may exceed the largest load at the ends of its ranges.
        const BEYOND: f64 = 3.0;
        if self.loads_confirmed {
            return Ok(());
        }
        let [low, high] = ELEMENT_RANGE;
        let FullScale { normal, shear } = self.full_scale;
        let largest = self.elements.iter().map(ElementCalibration::largest_force);
        let largest = largest.fold(0.0, f64::max);
        let is_usual = (low..=high).contains(&normal.max(shear))
            && (low / BEYOND..=high * BEYOND).contains(&largest);
        match is_usual {
            true => Ok(()),
            false => Err(CalibrationError::Magnitude {
                full_scale: normal.max(shear),
                largest,
            }),
        }
    }

    /// Converts `moments` to `forces` (N) for each element, regardless of validity. Neither allocates nor panics.
    pub fn forces(&self, moments: &[ElementMoments], forces: &mut [DVec3]) {
        for ((element, moments), force) in self.elements.iter().zip(moments).zip(forces) {
            *force = element.force(moments);
        }
    }

    /// Computes the validity of the force at each element. Neither allocates nor panics.
    pub fn validity(&self, moments: &[ElementMoments], validity: &mut [ForceValidity]) {
        for ((element, moments), validity) in self.elements.iter().zip(moments).zip(validity) {
            *validity = element.validity(moments);
        }
    }
}
