//! The content of an experiment file.

use super::error::ConfigError;
use super::ros2::RosConfig;
use feeler::check::Checker;
use feeler::control::ControlConfig;
use feeler::control::task::TaskConfig;
use feeler::hand::{FingerConfig, FingerDescription, JointCoupling};
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::forces::DriftConfig;
use feeler_drives::config::DrivesConfig;
use feeler_sim::objects::{ObjectConfig, ThreadConfig};
use feeler_sim::world::SimConfig;
use serde::{Deserialize, Serialize};

/// Configuration of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentConfig {
    /// Short name, used for the run's folder: letters, digits and hyphens.
    pub name: String,
    /// Description of the experiment in one sentence.
    #[serde(default)]
    pub description: String,
    /// Random seed.
    #[serde(default)]
    pub seed: u64,
    /// Seed for which the hand in this file was drawn; see
    /// `plausible_hand`. If present and different from `seed`, another
    /// plausible hand is drawn on loading.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible_hand: Option<i64>,
    /// Sensing model of the simulation.
    #[serde(default)]
    pub sensing: Sensing,
    /// Maximum duration of the run in simulated time (s).
    #[serde(default = "a_minute")]
    pub time_limit: f64,
    /// The fingertips' sensors.
    pub sensor: SensorConfig,
    /// The hand's fingers.
    #[serde(default)]
    pub hand: HandConfig,
    /// The control law.
    #[serde(default)]
    pub control: ControlConfig,
    /// The hand's task.
    pub task: TaskConfig,
    /// Servos of the hand, if feeler drives them directly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drives: Option<DrivesConfig>,
    /// Robot of a ROS 2 graph that serves as the hand, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ros2: Option<RosConfig>,
    /// The simulated world. `None` for a real rig.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sim: Option<SimConfig>,
}

fn a_minute() -> f64 {
    60.0
}

/// Source of the forces that the controller receives in simulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sensing {
    /// Rendered camera images, moments and calibration.
    #[default]
    Image,
    /// The simulated feelers' forces plus noise; faster.
    Direct,
}

/// Sensors of the fingertips; defaults for all fingers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorConfig {
    /// Calibration file, relative to the experiment file; written by `feeler calibrate`.
    pub calibration: String,
    /// Geometry of the elements, the camera and the evaluation of moments.
    #[serde(default)]
    pub fingertip: FingertipConfig,
    /// Tolerances for the compensation of lamp drift and slow creep. Without this table, drift is not compensated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftConfig>,
    /// Settings of individual fingers: either empty, or one entry per finger of the hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub finger: Vec<FingerSensorConfig>,
}

/// Settings of one finger's sensor that differ from the defaults in [`SensorConfig`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerSensorConfig {
    /// Calibration file of this finger. Default: `sensor.calibration`.
    #[serde(default)]
    pub calibration: Option<String>,
    /// Fingertip of this finger. Default: `sensor.fingertip`.
    #[serde(default)]
    pub fingertip: Option<FingertipConfig>,
}

impl ExperimentConfig {
    /// Returns the simulated world.
    ///
    /// # Errors
    /// If the experiment describes a real rig.
    pub fn simulation(&self) -> Result<&SimConfig, ConfigError> {
        self.sim.as_ref().ok_or_else(|| ConfigError::NoSimulation {
            name: self.name.clone(),
        })
    }

    /// Returns the simulated cap, which is the first object with a thread: its name, configuration and thread.
    pub fn cap(&self) -> Option<(&str, &ObjectConfig, &ThreadConfig)> {
        self.sim.as_ref()?.cap()
    }

    /// Returns `true` if the servos of the table `[drives]` measure their efforts.
    pub fn measures_efforts(&self) -> bool {
        let drives = self.drives.as_ref();
        drives.is_some_and(DrivesConfig::measures_efforts)
    }

    /// Joints of different fingers that one servo of the table `[drives]` moves.
    pub fn couplings(&self) -> Vec<JointCoupling> {
        let drives = self.drives.as_ref();
        drives.map_or_else(Vec::new, DrivesConfig::couplings)
    }
}

impl SensorConfig {
    /// Requires every value of the table `key` to be in its range.
    pub(super) fn check(&self, key: &str, checker: &mut Checker) {
        self.fingertip.check(&format!("{key}.fingertip"), checker);
        for (finger, own) in self.finger.iter().enumerate() {
            if let Some(fingertip) = &own.fingertip {
                fingertip.check(&format!("{key}.finger[{finger}].fingertip"), checker);
            }
        }
        if let Some(drift) = &self.drift {
            drift.check(&format!("{key}.drift"), checker);
        }
    }

    /// Returns the fingertip of `finger`.
    pub fn fingertip(&self, finger: usize) -> &FingertipConfig {
        let own = self.finger.get(finger);
        own.and_then(|own| own.fingertip.as_ref())
            .unwrap_or(&self.fingertip)
    }

    /// Returns the calibration file of `finger`, and the key that contains it.
    pub fn calibration(&self, finger: usize) -> (&str, String) {
        let own = self.finger.get(finger);
        match own.and_then(|own| own.calibration.as_deref()) {
            Some(file) => (file, format!("sensor.finger[{finger}].calibration")),
            None => (&self.calibration, "sensor.calibration".to_string()),
        }
    }
}

/// Geometry of the hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HandConfig {
    /// The fingers, in the order of the task's fingers.
    pub finger: Vec<FingerDescription>,
}

impl Default for HandConfig {
    /// Hand of the reference experiment: two fingers that face each other across a cap on W's z axis.
    fn default() -> Self {
        let finger = |x: f64, phi1_deg, joint_lower_deg, joint_upper_deg| {
            FingerDescription::ThreeJoints(FingerConfig {
                base_position: [x, 0.0, 0.0576],
                phi1_deg,
                phi2_deg: 0.0,
                links: [0.030, 0.060, 0.055],
                joint_lower_deg,
                joint_upper_deg,
                joint_speed_limit: [2.0, 2.0, 2.0],
            })
        };
        Self {
            finger: vec![
                finger(-0.1655, 0.0, [-60.0, -30.0, -150.0], [60.0, 120.0, 0.0]),
                finger(0.1655, 180.0, [-60.0, -120.0, 0.0], [60.0, 30.0, 150.0]),
            ],
        }
    }
}
