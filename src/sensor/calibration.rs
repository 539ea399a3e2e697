//! From moments to forces: the calibration of one fingertip, and its file.
//!
//! The separable calibration of the paper (section II), for each element: `F_z = g(G)`,
//! `F_x = f_x(u_x)`, `F_y = f_y(u_y)`, where `u = c - c_0` is the displacement of the centroid from
//! its unloaded place. It knows nothing of how a normal force changes the displacement that a shear
//! force causes; the error that this leaves is on record in [`ElementCalibration::held_out`].

use super::{
    difference::{Difference, first_difference},
    fingertip::FingertipConfig,
    moments::ElementMoments,
};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Version of the calibration file that this program reads and writes.
pub const CALIBRATION_VERSION: u32 = 1;

/// Terms of a [`ForceCurve`].
pub const CURVE_TERMS: usize = 3;

/// Why a calibration cannot be made, read or used.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The text is no calibration.
    #[error("not a calibration file: {0}")]
    Parse(#[from] toml::de::Error),
    /// The calibration cannot be written as text.
    #[error("the calibration cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file is of another version.
    #[error("calibration file version {CALIBRATION_VERSION} expected, got {actual}")]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// The calibration was made for another fingertip.
    #[error(
        "the calibration is for another fingertip: {part} has {key} = {expected} here, \
         {actual} in the calibration; `feeler calibrate` makes one for the fingertip here"
    )]
    OtherFingertip {
        /// What differs: the layout, the camera or the moments.
        part: &'static str,
        /// The first value of it that differs.
        key: String,
        /// As configured.
        expected: String,
        /// As calibrated.
        actual: String,
    },
    /// A number of elements, or of lists of loads, is wrong.
    #[error("{what} for {expected} elements expected, got {actual}")]
    ElementCount {
        /// What was counted.
        what: &'static str,
        /// Elements of the fingertip.
        expected: usize,
        /// How many arrived.
        actual: usize,
    },
    /// A number in the calibration is not usable.
    #[error("element {element}: {what}")]
    Unusable {
        /// Index of the element.
        element: usize,
        /// Expected and actual.
        what: String,
    },
}

/// A force as a polynomial of one input, zero at zero.
///
/// Inside the range of inputs it was fitted on, `F(s) = c_1 s + c_2 s^2 + c_3 s^3`. Outside, the
/// polynomial may do anything, so the curve goes on from the range's end as a straight line with the
/// mean slope of the whole curve: where the picture keeps growing stronger, so does the force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceCurve {
    /// Least and greatest input among the loads, no load included: 0 lies within.
    pub range: [f64; 2],
    /// `c_1, c_2, c_3`, N per power of the input.
    pub coefficients: [f64; CURVE_TERMS],
}

impl ForceCurve {
    /// Force at `input`, N. Finite for every finite input.
    pub fn force(&self, input: f64) -> f64 {
        let [low, high] = self.range;
        let inside = input.max(low).min(high);
        self.polynomial(inside) + (input - inside) * self.mean_slope()
    }

    fn polynomial(&self, s: f64) -> f64 {
        self.coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, c| (sum + c) * s)
    }

    fn mean_slope(&self) -> f64 {
        let [low, high] = self.range;
        (self.polynomial(high) - self.polynomial(low)) / (high - low)
    }
}

/// Errors on loads that the fit has not seen, N, along x, y, z of the element's frame `E_i`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutError {
    /// Root mean square, N.
    pub rms: DVec3,
    /// Largest magnitude, N.
    pub worst: DVec3,
}

/// The calibration of one element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementCalibration {
    /// Integrated gray value without load, grey levels times m².
    pub unloaded_gray: f64,
    /// Centroid without load, m, in x, y of `E_i`.
    pub unloaded_centroid: DVec2,
    /// Compression `F_z` over the relative growth of the integrated gray value, `G / G_0 - 1`.
    pub normal: ForceCurve,
    /// Shear `F_x` over the centroid's displacement along x, m.
    pub shear_x: ForceCurve,
    /// Shear `F_y` over the centroid's displacement along y, m.
    pub shear_y: ForceCurve,
    /// How far it is off.
    pub held_out: HeldOutError,
}

impl ElementCalibration {
    /// The force at the element in its frame `E_i`, N (sign: see
    /// [`TactileFrame`](super::reading::TactileFrame)). Finite for all finite moments; `F_z` is below
    /// zero where the picture is darker than without load.
    pub fn force(&self, moments: &ElementMoments) -> DVec3 {
        let displacement = moments.centroid - self.unloaded_centroid;
        let growth = moments.integrated_gray / self.unloaded_gray - 1.0;
        DVec3::new(
            self.shear_x.force(displacement.x),
            self.shear_y.force(displacement.y),
            self.normal.force(growth),
        )
    }

    /// Refuses numbers that would make a force infinite or not a number.
    fn check(&self, element: usize) -> Result<(), CalibrationError> {
        let unusable = |what: String| Err(CalibrationError::Unusable { element, what });
        if !(self.unloaded_gray.is_finite() && self.unloaded_gray > 0.0) {
            let gray = self.unloaded_gray;
            return unusable(format!("unloaded_gray must be positive, got {gray}"));
        }
        if !self.unloaded_centroid.is_finite() {
            let centroid = self.unloaded_centroid;
            return unusable(format!("unloaded_centroid must be finite, got {centroid}"));
        }
        let curves = [
            ("normal", &self.normal),
            ("shear_x", &self.shear_x),
            ("shear_y", &self.shear_y),
        ];
        for (name, curve) in curves {
            let [low, high] = curve.range;
            if !(low.is_finite() && high.is_finite() && low < high && low <= 0.0 && high >= 0.0) {
                return unusable(format!(
                    "{name}.range must rise and hold 0, got {low} to {high}"
                ));
            }
            if !(curve.force(low).is_finite() && curve.mean_slope().is_finite()) {
                let coefficients = curve.coefficients;
                return unusable(format!(
                    "{name}.coefficients must give finite forces, got {coefficients:?}"
                ));
            }
        }
        Ok(())
    }
}

/// The calibration of all elements of one fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the file, [`CALIBRATION_VERSION`].
    pub version: u32,
    /// The fingertip that it was made for.
    pub fingertip: FingertipConfig,
    /// Its elements, in the layout's order.
    pub elements: Vec<ElementCalibration>,
}

/// Only the version, to tell a file of another version from a broken one.
#[derive(Deserialize)]
struct VersionOnly {
    version: u32,
}

impl Calibration {
    /// Reads a calibration from the text of its file.
    ///
    /// # Errors
    /// When the text is not a calibration of this version, or a number in it cannot be used.
    pub fn from_toml(text: &str) -> Result<Self, CalibrationError> {
        let VersionOnly { version } = toml::from_str(text)?;
        if version != CALIBRATION_VERSION {
            return Err(CalibrationError::Version { actual: version });
        }
        let calibration: Self = toml::from_str(text)?;
        calibration.check()?;
        Ok(calibration)
    }

    /// The text of the calibration's file.
    ///
    /// # Errors
    /// When a value has no form in TOML.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        Ok(toml::to_string(self)?)
    }

    /// Refuses a calibration that was made for anything but `fingertip`.
    ///
    /// # Errors
    /// When the layout, the camera or the way of taking moments differs.
    pub fn check_made_for(&self, fingertip: &FingertipConfig) -> Result<(), CalibrationError> {
        let (here, there) = (fingertip, &self.fingertip);
        same("the layout", &here.layout, &there.layout)?;
        same("the camera", &here.camera, &there.camera)?;
        same("the way of taking moments", &here.moments, &there.moments)
    }

    /// Refuses numbers that cannot be used.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        let expected = self.fingertip.layout.element_count();
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
            .try_for_each(|(index, element)| element.check(index))
    }

    /// Turns `moments` into `forces`, element by element, N. Neither allocates nor panics.
    pub fn forces(&self, moments: &[ElementMoments], forces: &mut [DVec3]) {
        for ((element, moments), force) in self.elements.iter().zip(moments).zip(forces) {
            *force = element.force(moments);
        }
    }
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
