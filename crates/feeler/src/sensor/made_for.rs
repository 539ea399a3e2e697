//! What a calibration belongs to, and how that is told from anything else.

use super::{
    calibration_error::CalibrationError,
    difference::{Difference, first_difference},
    fingertip::FingertipConfig,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Unit of lengths in the picture's moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Metres in the element's tangent plane: the fingertip's geometry is known.
    #[serde(rename = "m")]
    Metre,
    /// Pixels of the picture: it is not.
    #[serde(rename = "px")]
    Pixel,
}

/// The fingertip or layout that a calibration was made for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MadeFor {
    /// SHA-256 of its canonical text, in hexadecimal digits.
    pub sha256: String,
    /// Number of its elements.
    pub elements: usize,
    /// Unit of centroids; that of integrated gray values is grey levels times its square.
    pub length_unit: LengthUnit,
    /// The fingertip itself, where it is known by its geometry; its canonical text is its TOML.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingertip: Option<FingertipConfig>,
}

/// How a sensor is known: two of different kinds have no values to compare.
#[derive(PartialEq, Serialize)]
struct KnownBy {
    known_by: &'static str,
}

impl MadeFor {
    /// A fingertip of known geometry.
    ///
    /// # Errors
    /// When a value of it has no form in TOML.
    pub fn fingertip(config: &FingertipConfig) -> Result<Self, CalibrationError> {
        Ok(Self {
            sha256: sha256(&toml::to_string(config)?),
            elements: config.layout.element_count(),
            length_unit: LengthUnit::Metre,
            fingertip: Some(config.clone()),
        })
    }

    /// A layout of `elements` elements known by its canonical text alone, moments in `length_unit`.
    pub fn layout(canonical_text: &str, elements: usize, length_unit: LengthUnit) -> Self {
        Self {
            sha256: sha256(canonical_text),
            elements,
            length_unit,
            fingertip: None,
        }
    }

    /// Refuses a calibration made for `there` where it is to be used with `self`.
    ///
    /// # Errors
    /// Names the first value that differs, or both hashes where there are no values to compare.
    pub fn check_same(&self, there: &Self) -> Result<(), CalibrationError> {
        if self == there {
            return Ok(());
        }
        if let (Some(here), Some(there)) = (&self.fingertip, &there.fingertip) {
            same("the layout", &here.layout, &there.layout)?;
            same("the camera", &here.camera, &there.camera)?;
            same("the way of taking moments", &here.moments, &there.moments)?;
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

    /// Refuses a fingertip that is not the one whose hash stands beside it.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
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
/// The SHA-256 of `text`, in hexadecimal digits.
pub fn sha256(text: &str) -> String {
    let mut digits = String::with_capacity(64);
    for byte in Sha256::digest(text.as_bytes()) {
        // Writing to a string cannot fail.
        let _ = write!(digits, "{byte:02x}");
    }
    digits
}

/// Refuses a difference between what is configured and what was calibrated.
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
