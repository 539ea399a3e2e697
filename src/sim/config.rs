//! The simulated world, as an experiment file describes it.

use super::cap::CapConfig;
use super::feeler::FeelerConfig;
use super::optics_config::OpticsConfig;
use super::servo::ServoConfig;
use super::torque_sensor::TorqueSensorConfig;
use serde::{Deserialize, Serialize};

/// How much runs of different seeds differ. Every quantity is drawn uniformly once per run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariationConfig {
    /// Greatest offset of the bottle from its place along W's x and y, m.
    pub bottle_position: f64,
    /// Greatest relative change of both friction coefficients.
    pub friction: f64,
    /// Greatest relative change of the seat angle.
    pub seat_angle: f64,
    /// Greatest rotation of the cap at the start, rad. A round cap shows none of it.
    pub cap_angle: f64,
}

/// The simulated world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimConfig {
    /// Time step of the physics, s.
    pub step: f64,
    /// The feelers on both fingertips.
    pub feeler: FeelerConfig,
    /// The cap.
    pub cap: CapConfig,
    /// The torque sensor under the bottle.
    pub torque_sensor: TorqueSensorConfig,
    /// The drives of the fingers.
    pub servo: ServoConfig,
    /// What differs from run to run.
    pub variation: VariationConfig,
    /// What the camera's picture is made of.
    pub optics: OpticsConfig,
    /// Noise of forces that are sensed without pictures.
    pub direct_sensing: DirectSensingConfig,
}

/// Noise of forces that are sensed without pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectSensingConfig {
    /// Standard deviation of an element's normal force, N.
    pub normal_noise: f64,
    /// Standard deviation of either component of an element's shear force, N.
    pub shear_noise: f64,
}
