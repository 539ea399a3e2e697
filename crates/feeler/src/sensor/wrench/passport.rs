//! Passport of a wrench calibration: date, conditions, and later tests of its validity.
//!
//! Ranges and held-out errors are part of the calibration ([`AxisQuality`](super::quality::AxisQuality)).

use super::WrenchAxis;
use super::quality::Errors;
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

/// Result of testing a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Verification {
    /// Date of the test, UTC, as in 2026-11-28.
    pub date: String,
    /// Maximum probability of rejecting a valid calibration, if presses are independent.
    pub false_alarm_rate: f64,
    /// `true` if no component was rejected.
    pub valid: bool,
    /// Result for each measured component of the calibration.
    pub axes: Vec<AxisVerification>,
}

/// Result of testing one component.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisVerification {
    /// The component.
    pub axis: WrenchAxis,
    /// Number of presses.
    pub presses: usize,
    /// Number of presses with more than half of the samples outside the 95 % band, or not similar to the calibration's
    /// samples.
    pub outside: usize,
    /// Minimum number of presses outside the band for which the component is rejected.
    pub rejected_from: usize,
    /// Errors of the valid samples (N, N·m or m); `None` if no sample is valid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
    /// Slope of the regression of measured on predicted values, minus 1; `None` if predictions are constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_drift: Option<f64>,
}

impl AxisVerification {
    /// Returns `true` if the component was rejected.
    pub fn is_rejected(&self) -> bool {
        self.outside >= self.rejected_from
    }
}
