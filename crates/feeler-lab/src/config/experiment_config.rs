//! Everything that an experiment file says.

use super::error::ConfigError;
use super::ros2::RosConfig;
use feeler::check::Checker;
use feeler::control::controller::ControlConfig;
use feeler::control::task::TaskConfig;
use feeler::hand::finger::FingerConfig;
use feeler::sensor::drift::DriftConfig;
use feeler::sensor::fingertip::FingertipConfig;
use feeler_drives::config::DrivesConfig;
use feeler_sim::config::SimConfig;
use feeler_sim::object::ObjectConfig;
use feeler_sim::thread::ThreadConfig;
use serde::{Deserialize, Serialize};

/// Everything that an experiment is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentConfig {
    /// Short name, used for the run's folder: letters, digits and hyphens.
    pub name: String,
    /// What the experiment shows, in a sentence.
    #[serde(default)]
    pub description: String,
    /// Random seed.
    #[serde(default)]
    pub seed: u64,
    /// Seed that the hand in this file was drawn for, if every seed draws another plausible hand; see
    /// [`plausible_hand`](crate::sweep::plausible::plausible_hand). Drawn anew if it differs from `seed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible_hand: Option<i64>,
    /// Whether simulated forces go through rendered pictures.
    #[serde(default)]
    pub sensing: Sensing,
    /// The run is stopped at this simulated time, s.
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
    /// What the hand does.
    pub task: TaskConfig,
    /// The servos that move the hand, where feeler speaks to them itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drives: Option<DrivesConfig>,
    /// The robot of a ROS 2 graph that is the hand, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ros2: Option<RosConfig>,
    /// The simulated world that it does it in; none of a real rig.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sim: Option<SimConfig>,
}

fn a_minute() -> f64 {
    60.0
}

/// How the controller comes by its forces.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sensing {
    /// Through rendered camera frames, moments and calibration.
    #[default]
    Image,
    /// The feelers' forces plus noise, for speed.
    Direct,
}

/// The fingertips' sensors: what all have that say nothing else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorConfig {
    /// File of the calibration, relative to the experiment's; made by `feeler calibrate`.
    pub calibration: String,
    /// The elements, the camera that looks at them, and how moments are taken of its picture.
    #[serde(default)]
    pub fingertip: FingertipConfig,
    /// Drift of the lamp and slow creep are taken out of the moments, with these tolerances; without
    /// it, they are not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftConfig>,
    /// What each finger has of its own: nothing, or an entry per finger of the hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub finger: Vec<FingerSensorConfig>,
}

/// One finger's sensor, as far as it differs from the others.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerSensorConfig {
    /// File of its calibration; without it, `sensor.calibration`.
    #[serde(default)]
    pub calibration: Option<String>,
    /// Its fingertip; without it, `sensor.fingertip`.
    #[serde(default)]
    pub fingertip: Option<FingertipConfig>,
}

impl ExperimentConfig {
    /// The simulated world.
    ///
    /// # Errors
    /// When there is none: the experiment is for a real rig.
    pub fn simulation(&self) -> Result<&SimConfig, ConfigError> {
        self.sim.as_ref().ok_or_else(|| ConfigError::NoSimulation {
            name: self.name.clone(),
        })
    }

    /// The simulated cap: the first object on a thread, its name, itself and its thread.
    pub fn cap(&self) -> Option<(&str, &ObjectConfig, &ThreadConfig)> {
        self.sim.as_ref()?.cap()
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

    /// The fingertip of `finger`.
    pub fn fingertip(&self, finger: usize) -> &FingertipConfig {
        let own = self.finger.get(finger);
        own.and_then(|own| own.fingertip.as_ref())
            .unwrap_or(&self.fingertip)
    }

    /// The calibration file of `finger`, and the key that names it.
    pub fn calibration(&self, finger: usize) -> (&str, String) {
        let own = self.finger.get(finger);
        match own.and_then(|own| own.calibration.as_deref()) {
            Some(file) => (file, format!("sensor.finger[{finger}].calibration")),
            None => (&self.calibration, "sensor.calibration".to_string()),
        }
    }
}

/// The hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HandConfig {
    /// The fingers, in the order of the task's fingers.
    pub finger: Vec<FingerConfig>,
}

impl Default for HandConfig {
    /// The reference experiment's: two fingers that face each other across a cap on W's z axis.
    fn default() -> Self {
        let finger = |x: f64, phi1_deg, joint_lower_deg, joint_upper_deg| FingerConfig {
            base_position: [x, 0.0, 0.0576],
            phi1_deg,
            phi2_deg: 0.0,
            links: [0.030, 0.060, 0.055],
            joint_lower_deg,
            joint_upper_deg,
            joint_speed_limit: [2.0, 2.0, 2.0],
        };
        Self {
            finger: vec![
                finger(-0.1655, 0.0, [-60.0, -30.0, -150.0], [60.0, 120.0, 0.0]),
                finger(0.1655, 180.0, [-60.0, -120.0, 0.0], [60.0, 30.0, 150.0]),
            ],
        }
    }
}
