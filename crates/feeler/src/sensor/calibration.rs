//! From moments to forces: the calibration of one fingertip, and its file.
//!
//! Two models: [`separable`](super::separable), the paper's, one curve for each component of the
//! force; and [`coupled`](super::coupled), each component from all moments together. Either takes an
//! element's moments relative to its unloaded ones ([`Inputs`]). How far a calibration can be trusted
//! stands in it ([`ElementQuality`]).

pub use super::calibration_error::CalibrationError;
pub use super::calibration_quality::{ElementQuality, FullScale, HeldOutError, explained};
pub use super::coupled::CoupledMap;
pub use super::made_for::{LengthUnit, MadeFor};
pub use super::separable::{CURVE_TERMS, ForceCurve, SeparableMap};
use super::{
    calibration_signs::check_signs, fingertip::FingertipConfig, load_check::ELEMENT_RANGE,
    moments::ElementMoments,
};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Version of the calibration file that this program reads and writes.
pub const CALIBRATION_VERSION: u32 = 2;

/// An element's moments relative to those without load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {
    /// Relative growth of the integrated gray value, `G / G_0 - 1`.
    pub growth: f64,
    /// Displacement of the centroid, `c - c_0`, m (or px) in x, y of `E_i`.
    pub displacement: DVec2,
}

impl Inputs {
    /// `moments` relative to the integrated gray value and centroid without load.
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

/// How forces follow from moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CalibrationModel {
    /// One curve for each component of the force (paper, section II).
    Separable,
    /// Each component from all moments together.
    Coupled,
}

/// The map from an element's moments to the force on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceMap {
    /// One curve for each component of the force.
    Separable(SeparableMap),
    /// Each component from all moments together.
    Coupled(CoupledMap),
}

impl ForceMap {
    /// The force in `E_i`, N. Finite for all inputs that are numbers.
    pub fn force(&self, inputs: Inputs) -> DVec3 {
        match self {
            Self::Separable(map) => map.force(inputs),
            Self::Coupled(map) => map.force(inputs),
        }
    }

    /// Least and greatest growth, displacement along x and along y among the loads.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        match self {
            Self::Separable(map) => map.ranges(),
            Self::Coupled(map) => map.ranges(),
        }
    }

    /// Whether `inputs` are within the ranges of the loads, or beyond them by at most the part `margin` of each.
    pub(super) fn covers(&self, inputs: Inputs, margin: f64) -> bool {
        let Inputs {
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

    /// Which of the two it is.
    pub fn model(&self) -> CalibrationModel {
        match self {
            Self::Separable(_) => CalibrationModel::Separable,
            Self::Coupled(_) => CalibrationModel::Coupled,
        }
    }
}

/// How far the force at one element can be trusted in one picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceValidity {
    /// Moments such as the calibration's loads caused.
    Calibrated,
    /// Beyond what its loads caused, by more than a tenth of their range: the force is a guess at a
    /// straight line. Most saturated and overexposed sub-regions are here.
    Extrapolated,
    /// Less than half as bright as without load, or not a number: the light, the camera or the element
    /// failed, and the force means nothing.
    Dark,
}

/// The calibration of one element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementCalibration {
    /// Integrated gray value without load, grey levels times m² (or px²).
    pub unloaded_gray: f64,
    /// Centroid without load, m (or px), in x, y of `E_i`.
    pub unloaded_centroid: DVec2,
    /// From moments to force.
    pub map: ForceMap,
    /// How far it is off.
    pub quality: ElementQuality,
}

impl ElementCalibration {
    /// The moments relative to those without load.
    pub fn inputs(&self, moments: &ElementMoments) -> Inputs {
        Inputs::relative(moments, self.unloaded_gray, self.unloaded_centroid)
    }

    /// The force at the element in its frame `E_i`, N (sign: see
    /// [`TactileFrame`](super::reading::TactileFrame)). Finite for all finite moments; `F_z` is below
    /// zero where the picture is darker than without load.
    pub fn force(&self, moments: &ElementMoments) -> DVec3 {
        self.map.force(self.inputs(moments))
    }

    /// How far the force under `moments` can be trusted.
    pub fn validity(&self, moments: &ElementMoments) -> ForceValidity {
        /// Part of a range by which noise may exceed it.
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

    /// The largest force at the ends of the ranges of growth and displacement, each by itself, N.
    fn largest_force(&self) -> f64 {
        let [growth, along_x, along_y] = self.map.ranges();
        let grown = growth.map(|growth| (growth, DVec2::ZERO));
        let moved_x = along_x.map(|x| (0.0, x * DVec2::X));
        let moved_y = along_y.map(|y| (0.0, y * DVec2::Y));
        let ends = grown.into_iter().chain(moved_x).chain(moved_y);
        let forces = ends.map(|(growth, displacement)| {
            let inputs = Inputs {
                growth,
                displacement,
            };
            self.map.force(inputs).length()
        });
        forces.fold(0.0, f64::max)
    }

    /// Refuses numbers that would make a force infinite or not a number.
    fn check(&self, element: usize) -> Result<(), CalibrationError> {
        let unusable = |what: String| CalibrationError::Unusable { element, what };
        // A tiny unloaded value would make growth infinite.
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

/// The calibration of all elements of one fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the file, [`CALIBRATION_VERSION`].
    pub version: u32,
    /// Unit of all forces: `"N"`.
    pub force_unit: ForceUnit,
    /// What shares of full scale refer to.
    pub full_scale: FullScale,
    /// Whether loads outside of the usual range ([`ELEMENT_RANGE`]) were confirmed when it was made.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub loads_confirmed: bool,
    /// What it was made for.
    pub made_for: MadeFor,
    /// Its elements, in the layout's order.
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
        calibration.check_magnitude()?;
        Ok(calibration)
    }

    /// The text of the calibration's file.
    ///
    /// # Errors
    /// When a value has no form in TOML.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        Ok(toml::to_string(self)?)
    }

    /// Which model it is of: that of its first element.
    pub fn model(&self) -> CalibrationModel {
        let first = self.elements.first();
        first.map_or(CalibrationModel::Separable, |element| element.map.model())
    }

    /// Refuses a calibration that was made for anything but `fingertip`.
    ///
    /// # Errors
    /// When the layout, the camera or the way of taking moments differs.
    pub fn check_made_for(&self, fingertip: &FingertipConfig) -> Result<(), CalibrationError> {
        MadeFor::fingertip(fingertip)?.check_same(&self.made_for)
    }

    /// Refuses numbers that cannot be used.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
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

    /// Refuses a calibration whose largest forces no soft element bears, or no picture shows, as forces in another unit are. One that is
    /// refused is refused again whenever its file is read.
    ///
    /// # Errors
    /// Full scale or the forces at the ends of the ranges are out of range, and loads are not [confirmed](Self::loads_confirmed).
    pub fn check_magnitude(&self) -> Result<(), CalibrationError> {
        /// A map may be this many times beyond the largest load at the ends of its ranges.
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

    /// Turns `moments` into `forces`, element by element, N, whatever their validity. Neither allocates
    /// nor panics.
    pub fn forces(&self, moments: &[ElementMoments], forces: &mut [DVec3]) {
        for ((element, moments), force) in self.elements.iter().zip(moments).zip(forces) {
            *force = element.force(moments);
        }
    }

    /// How far the force at each element can be trusted. Neither allocates nor panics.
    pub fn validity(&self, moments: &[ElementMoments], validity: &mut [ForceValidity]) {
        for ((element, moments), validity) in self.elements.iter().zip(moments).zip(validity) {
            *validity = element.validity(moments);
        }
    }
}
