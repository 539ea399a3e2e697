//! Calibration of one fingertip and its file. It contains the accuracy of each element
//! ([`ElementQuality`](super::quality::ElementQuality)).

use super::element::{CalibrationModel, ElementCalibration, ForceValidity};
use super::error::{CALIBRATION_VERSION, CalibrationError};
use super::load_range::ELEMENT_RANGE;
use super::quality::FullScale;
use super::signs::check_signs;
use crate::sensor::fingertip::made_for::CalibrationTarget;
use crate::sensor::fingertip::model::FingertipConfig;
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;
use serde::{Deserialize, Serialize};

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

/// Fields needed to read only the version, to distinguish a file of another version from an invalid file.
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
    /// If full scale or the forces at the ends of the input ranges are implausible, and the loads are not
    /// [confirmed](Self::loads_confirmed).
    pub fn check_magnitude(&self) -> Result<(), CalibrationError> {
        /// Factor by which forces at the ends of the input ranges may exceed the plausible range.
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
