//! Passport of a wrench calibration: when and how it was made, and tests of its validity since.
//!
//! Ranges and held-out errors are part of the calibration ([`AxisQuality`](super::quality::AxisQuality)).

use super::WrenchAxis;
use super::quality::Errors;
use serde::{Deserialize, Serialize};

/// Passport of a calibration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Passport {
    /// Date of the calibration, UTC, as in 2026-11-28.
    pub date: String,
    /// Conditions of the calibration in the user's words, such as temperature and mount; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub conditions: String,
    /// SHA-256 of the calibration that was transferred from another copy of the sensor, in hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transferred_from: Option<String>,
    /// SHA-256 of the file's canonical TOML with this field empty, in hexadecimal digits.
    pub sha256: String,
    /// Tests of the calibration, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub verifications: Vec<Verification>,
}

/// Result of testing a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Verification {
    /// Date of the test, UTC, as in 2026-11-28.
    pub date: String,
    /// Maximum probability that a valid calibration is rejected if presses are independent.
    pub false_alarm_rate: f64,
    /// `true` if no component was rejected.
    pub valid: bool,
    /// Result for each component of the calibration that was measured.
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
    /// Number of presses with more than half of the samples outside the 95 % band, or unlike those of the calibration.
    pub outside: usize,
    /// Minimum number of presses outside for which the component is rejected.
    pub rejected_from: usize,
    /// Errors of the valid samples, N, N m or m; `None` without any.
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
