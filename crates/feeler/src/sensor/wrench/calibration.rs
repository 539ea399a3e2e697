//! Wrench calibration of one fingertip and its file format.

use super::basis::Basis;
use super::error::{VERSION, WrenchError};
pub use super::model::{AxisModel, WrenchModel};
use super::moments::MomentBasis;
use super::novelty::MAX_DIRECTIONS;
use super::passport::{Passport, Verification};
use super::quality::AxisQuality;
use super::{AXES, WrenchAxis};
use crate::sensor::calibration::load_range::FINGERTIP_RANGE;
use crate::sensor::fingertip::made_for::CalibrationTarget;
use crate::sensor::fingertip::sha256;
use crate::sensor::table::Quantity;
use serde::{Deserialize, Serialize};

/// Maximum absolute value of a number in the file: far above any measurement and far below overflow of sums.
pub(super) const LARGEST: f64 = 1e15;

/// The wrench calibration of a camera's fingertip.
pub type WrenchCalibration = CalibrationOf<MomentBasis>;

/// The wrench calibration of one fingertip with features `B`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "")]
pub struct CalibrationOf<B: Basis> {
    /// Kind of the file, [`Basis::KIND`].
    pub kind: String,
    /// Version of the file format, [`VERSION`].
    pub version: u32,
    /// `true` if forces outside the plausible range ([`FINGERTIP_RANGE`]) were confirmed during calibration.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub loads_confirmed: bool,
    /// `true` if the elements of a camera's sensor are [tracked as
    /// markers](crate::sensor::forces::SensingChain::with_tracker); always `false` for taxels.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tracked: bool,
    /// Sensor for which the calibration was made.
    pub made_for: CalibrationTarget,
    /// Origin and later tests of the calibration; `None` for files of feeler 0.2 and older.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passport: Option<Passport>,
    /// Held-out errors of each component.
    pub quality: Vec<AxisQuality>,
    /// Prediction model.
    pub model: WrenchModel<B>,
}

/// Fields that identify the file.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    kind: String,
    #[serde(default)]
    version: u32,
}

impl<B: Basis> CalibrationOf<B> {
    /// Returns `true` if `text` is a wrench calibration file, of any version.
    pub fn is_kind(text: &str) -> bool {
        toml::from_str::<Header>(text).is_ok_and(|header| header.kind == B::KIND)
    }

    /// Parses a calibration from TOML.
    ///
    /// # Errors
    /// If the text is not a wrench calibration of the supported version, was changed after it was written, or contains an
    /// invalid number.
    pub fn from_toml(text: &str) -> Result<Self, WrenchError> {
        let Header { kind, version } = toml::from_str(text)?;
        if kind != B::KIND || version != VERSION {
            let expected = B::KIND;
            return Err(WrenchError::Version {
                expected,
                kind,
                version,
            });
        }
        let calibration: Self = toml::from_str(text)?;
        calibration.check_checksum()?;
        calibration.check()?;
        calibration.check_magnitude()?;
        Ok(calibration)
    }

    /// Formats the calibration as TOML.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn to_toml(&self) -> Result<String, WrenchError> {
        Ok(toml::to_string(self)?)
    }

    /// Sets the passport and its checksum.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn sign(&mut self, passport: Passport) -> Result<(), WrenchError> {
        self.passport = Some(passport);
        let sha256 = self.checksum()?;
        if let Some(passport) = &mut self.passport {
            passport.sha256 = sha256;
        }
        Ok(())
    }

    /// Appends a verification to the passport, and creates the passport if missing.
    pub fn add_verification(&mut self, verification: Verification) -> Result<(), WrenchError> {
        let mut passport = self.passport.take().unwrap_or_default();
        passport.verifications.push(verification);
        self.sign(passport)
    }

    /// SHA-256 of the canonical TOML without the checksum field.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn checksum(&self) -> Result<String, WrenchError> {
        let mut unsigned = self.clone();
        if let Some(passport) = &mut unsigned.passport {
            passport.sha256.clear();
        }
        Ok(sha256(&unsigned.to_toml()?))
    }

    /// Rejects a calibration that was modified after it was written. Accepts a calibration without a passport.
    fn check_checksum(&self) -> Result<(), WrenchError> {
        let Some(Passport { sha256, .. }) = &self.passport else {
            return Ok(());
        };
        let actual = self.checksum()?;
        match actual == *sha256 {
            true => Ok(()),
            false => Err(WrenchError::Checksum {
                expected: sha256.clone(),
                actual,
            }),
        }
    }

    /// Checks that the calibration was made for the sensor `here`.
    ///
    /// # Errors
    /// Returns [`WrenchError::CalibrationTarget`] with the difference.
    pub fn verify_target(&self, here: &CalibrationTarget) -> Result<(), WrenchError> {
        Ok(here.verify_same(&self.made_for)?)
    }

    /// Returns the model of a component, or `None` if it is not calibrated.
    pub fn axis(&self, axis: WrenchAxis) -> Option<&AxisModel<B::Terms>> {
        self.model.axes.iter().find(|model| model.axis == axis)
    }

    /// Rejects forces that are implausibly large or small for a soft fingertip, which indicates another unit.
    fn check_magnitude(&self) -> Result<(), WrenchError> {
        let forces = self
            .quality
            .iter()
            .filter(|quality| quality.axis.quantity() == Quantity::Force);
        let ends = forces.flat_map(|quality| quality.range);
        let largest = ends.map(f64::abs).fold(0.0, f64::max);
        let [low, high] = FINGERTIP_RANGE;
        // Without forces, there are only torques.
        match self.loads_confirmed || largest == 0.0 || (low..=high).contains(&largest) {
            true => Ok(()),
            false => Err(WrenchError::Magnitude { largest }),
        }
    }

    /// Rejects a calibration with invalid numbers.
    pub(super) fn check(&self) -> Result<(), WrenchError> {
        self.made_for.check()?;
        let basis = &self.model.elements;
        basis.check(self.made_for.elements)?;
        let axes = &self.model.axes;
        let sorted = axes.windows(2).all(|pair| pair[0].axis < pair[1].axis);
        if axes.is_empty() || axes.len() > AXES || !sorted {
            let names = axes.iter().map(|model| model.axis.name());
            return Err(WrenchError::Value {
                field: "model.axes".into(),
                value: format!("{:?}", names.collect::<Vec<_>>()),
                expected: "one or more of f_x, f_y, f_z, m_x, m_y, m_z, p_x, p_y, each once, in this order",
            });
        }
        for model in axes {
            let name = model.axis.name();
            check_count(
                &format!("{name}.weights"),
                basis.term_count(model.terms),
                model.weights.len(),
            )?;
            check_number(&format!("{name}.penalty"), model.penalty, 0.0..=LARGEST)?;
            let weights = model.weights.iter().chain([&model.intercept]);
            for &weight in weights {
                check_number(&format!("{name}.weights"), weight, -LARGEST..=LARGEST)?;
            }
        }
        for quality in &self.quality {
            let band = format!("{}.band_95", quality.axis.name());
            check_number(&band, quality.band_95.unwrap_or(0.0), 0.0..=LARGEST)?;
        }
        self.check_novelty()
    }

    fn check_novelty(&self) -> Result<(), WrenchError> {
        let novelty = &self.model.novelty;
        check_number("novelty.limit", novelty.limit, 1e-9..=LARGEST)?;
        check_number("novelty.rest", novelty.rest, 1e-9..=LARGEST)?;
        if novelty.directions.len() > MAX_DIRECTIONS || !B::supports_novelty(novelty.terms) {
            return Err(WrenchError::Value {
                field: "novelty".into(),
                value: format!("{} directions", novelty.directions.len()),
                expected: "at most 12 directions, and no squares",
            });
        }
        for direction in &novelty.directions {
            let terms = self.model.elements.term_count(novelty.terms);
            check_count("novelty.directions.along", terms, direction.along.len())?;
            check_number(
                "novelty.directions.variance",
                direction.variance,
                1e-9..=LARGEST,
            )?;
            for &part in &direction.along {
                check_number("novelty.directions.along", part, -2.0..=2.0)?;
            }
        }
        Ok(())
    }
}

pub(super) fn check_count(what: &str, expected: usize, actual: usize) -> Result<(), WrenchError> {
    if expected == actual {
        return Ok(());
    }
    let what = what.to_owned();
    Err(WrenchError::Count {
        what,
        expected,
        actual,
    })
}

pub(super) fn check_number(
    field: &str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
) -> Result<(), WrenchError> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(WrenchError::Value {
        field: field.to_owned(),
        value: value.to_string(),
        expected: "a finite number in its range",
    })
}
