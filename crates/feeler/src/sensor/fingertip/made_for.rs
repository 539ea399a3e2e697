//! Identity of the fingertip or layout for which a calibration was made.

use super::model::FingertipConfig;
use crate::sensor::calibration::error::CalibrationError;
use crate::sensor::image::difference::{Difference, first_difference};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Unit of lengths in the moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Metres in the element's tangent plane, if the fingertip's geometry is known.
    #[serde(rename = "m")]
    Metre,
    /// Pixels of the image, if it is unknown.
    #[serde(rename = "px")]
    Pixel,
}

/// The fingertip or layout for which a calibration was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationTarget {
    /// SHA-256 of the canonical text of the fingertip or layout, in hexadecimal digits.
    pub sha256: String,
    /// Number of elements.
    pub elements: usize,
    /// Unit of centroids. Integrated gray values are in gray levels times the square of this unit.
    pub length_unit: LengthUnit,
    /// The fingertip, if its geometry is known. Its canonical text is its TOML representation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingertip: Option<FingertipConfig>,
}

/// Fields that depend on the kind of sensor. The kind is compared first, because different kinds have no common fields.
#[derive(PartialEq, Serialize)]
struct KnownBy {
    known_by: &'static str,
}

impl CalibrationTarget {
    /// Describes a fingertip of known geometry.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn fingertip(config: &FingertipConfig) -> Result<Self, CalibrationError> {
        Ok(Self {
            sha256: sha256(&toml::to_string(config)?),
            elements: config.layout.element_count(),
            length_unit: LengthUnit::Metre,
            fingertip: Some(config.clone()),
        })
    }

    /// Describes a layout of `elements` elements with moments in `length_unit`, identified by its canonical text
    /// alone.
    pub fn layout(canonical_text: &str, elements: usize, length_unit: LengthUnit) -> Self {
        Self {
            sha256: sha256(canonical_text),
            elements,
            length_unit,
            fingertip: None,
        }
    }

    /// Checks that a calibration made for `there` can be used with the sensor `self`.
    ///
    /// # Errors
    /// Returns the first value that differs, or both hashes if there are no values to compare.
    pub fn verify_same(&self, there: &Self) -> Result<(), CalibrationError> {
        if self == there {
            return Ok(());
        }
        if let (Some(here), Some(there)) = (&self.fingertip, &there.fingertip) {
            same("the layout", &here.layout, &there.layout)?;
            same("the camera", &here.camera, &there.camera)?;
            same(
                "the configuration of the moments",
                &here.moments,
                &there.moments,
            )?;
        }
        same("the sensor", &self.known_by(), &there.known_by())?;
        same("the sensor", self, there)
    }

    fn known_by(&self) -> KnownBy {
        KnownBy {
            known_by: match self.fingertip {
                Some(_) => "the geometry in an experiment",
                None => "a located layout",
            },
        }
    }

    /// Checks that the fingertip matches the stored hash and number of elements.
    pub(in crate::sensor) fn check(&self) -> Result<(), CalibrationError> {
        let Some(fingertip) = &self.fingertip else {
            return Ok(());
        };
        let Self {
            sha256: expected,
            elements,
            ..
        } = Self::fingertip(fingertip)?;
        if expected != self.sha256 {
            let actual = self.sha256.clone();
            return Err(CalibrationError::Hash { expected, actual });
        }
        if elements != self.elements {
            return Err(CalibrationError::ElementCount {
                what: "made_for.elements",
                expected: elements,
                actual: self.elements,
            });
        }
        Ok(())
    }
}

/// SHA-256 of `text` in hexadecimal digits.
pub fn sha256(text: &str) -> String {
    let mut digits = String::with_capacity(64);
    for byte in Sha256::digest(text.as_bytes()) {
        // Writing to a string cannot fail.
        let _ = write!(digits, "{byte:02x}");
    }
    digits
}

/// Checks that a configured value equals the value in the calibration.
fn same<T: PartialEq + Serialize>(
    part: &'static str,
    expected: &T,
    actual: &T,
) -> Result<(), CalibrationError> {
    if expected == actual {
        return Ok(());
    }
    let Difference { key, left, right } = first_difference(expected, actual);
    Err(CalibrationError::OtherFingertip {
        part,
        key,
        expected: left,
        actual: right,
    })
}
