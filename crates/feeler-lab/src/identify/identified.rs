//! The file `identified.toml`: the estimates of a probing run, each with its 95 % interval and method.

use serde::{Deserialize, Serialize};

/// All estimates of a probing run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identified {
    /// Name of the probed experiment.
    pub experiment: String,
    /// Seed of the probing run.
    pub seed: u64,
    /// Warnings, one sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Estimates of the touched object.
    pub object: ObjectEstimates,
    /// Estimates of the fingers, in the order of the hand.
    pub finger: Vec<FingerEstimates>,
}

impl Identified {
    /// Returns the text of `identified.toml`.
    ///
    /// # Errors
    /// If a value cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

/// Estimates of the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectEstimates {
    /// x coordinate of the axis about which the object turns, in W (m).
    pub pivot_x: Estimate,
    /// y coordinate of the axis about which the object turns, in W (m).
    pub pivot_y: Estimate,
    /// Radius of the object at the contacts (m).
    pub radius: Estimate,
}

/// Estimates of one finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerEstimates {
    /// Standard deviation of the noise of one component of an element's force (N).
    pub force_noise: Estimate,
    /// Contact stiffness of an element along its axis (N/m).
    pub normal_stiffness: Estimate,
    /// Contact stiffness of an element across its axis (N/m).
    pub shear_stiffness: Estimate,
    /// Work lost in a cycle of pressing and releasing, relative to the work of pressing.
    pub hysteresis: Estimate,
    /// Coefficient of static friction.
    pub static_friction: Estimate,
    /// Coefficient of kinetic friction.
    pub kinetic_friction: Estimate,
    /// Time constant of the drives, as a first-order lag (s).
    pub servo_lag: Estimate,
    /// Delay from a command to the first change of force, without the drives' lag (s).
    pub dead_time: Estimate,
}

/// An estimated quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// Best estimate in SI units.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Method of estimation in a few words.
    pub method: String,
}
