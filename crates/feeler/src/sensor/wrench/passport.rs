//! Passport of a wrench calibration: date, conditions, and later tests of its validity.
//!
//! Ranges and held-out errors are part of the calibration ([`AxisQuality`](super::quality::AxisQuality)).

use super::basis::Basis;
use super::calibration::CalibrationOf;
use super::error::WrenchError;
use super::verification::Verification;
use crate::sensor::fingertip::sha256;
use serde::{Deserialize, Serialize};

/// Origin and test history of a calibration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Passport {
    /// Date of the calibration, UTC, as in 2026-11-28.
    pub date: String,
    /// Conditions of the calibration as entered by the user, such as temperature and mount; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub conditions: String,
    /// SHA-256 of the original calibration, in hexadecimal digits, if this one was transferred from another copy of the
    /// sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transferred_from: Option<String>,
    /// SHA-256 of the file's canonical TOML with this field empty, in hexadecimal digits.
    pub sha256: String,
    /// Later tests of the calibration, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub verifications: Vec<Verification>,
}

impl<B: Basis> CalibrationOf<B> {
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
    pub(super) fn check_checksum(&self) -> Result<(), WrenchError> {
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
}
