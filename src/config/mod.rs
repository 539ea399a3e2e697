//! The experiment file: one documented struct, read from TOML, checked once, turned once into
//! runtime objects.

mod check;
mod check_objects;
mod check_sim;
mod checker;
mod load;
mod settings;

pub use checker::Problem;
pub use load::{BUILT_IN, BuiltIn, ConfigError, Experiment};

use crate::control::controller::ControlConfig;
use crate::control::task::TaskConfig;
use crate::hand::finger::FingerConfig;
use crate::sensor::fingertip::FingertipConfig;
use crate::sim::config::SimConfig;
use serde::{Deserialize, Serialize};

/// Everything that an experiment is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentConfig {
    /// Short name, used for the run's folder: letters, digits and hyphens.
    pub name: String,
    /// What the experiment shows, in a sentence.
    pub description: String,
    /// Drives every random quantity of the run.
    pub seed: u64,
    /// Whether the forces go through rendered pictures.
    pub sensing: Sensing,
    /// The run is stopped at this simulated time, s.
    pub time_limit: f64,
    /// The fingertips' sensors; all alike.
    pub sensor: SensorConfig,
    /// The hand's fingers.
    pub hand: HandConfig,
    /// The control law.
    pub control: ControlConfig,
    /// What the hand does.
    pub task: TaskConfig,
    /// The world that it does it in.
    pub sim: SimConfig,
}

/// How the controller comes by its forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sensing {
    /// Through rendered camera frames, moments and calibration.
    Image,
    /// The feelers' forces plus noise, for speed.
    Direct,
}

/// A fingertip's sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorConfig {
    /// File of the calibration, relative to the experiment's; made by `feeler calibrate`.
    pub calibration: String,
    /// The elements, the camera that looks at them, and how moments are taken of its picture.
    pub fingertip: FingertipConfig,
}

/// The hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandConfig {
    /// The fingers, in the order of the task's fingers.
    pub finger: Vec<FingerConfig>,
}
