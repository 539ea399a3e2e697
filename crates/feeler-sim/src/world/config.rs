//! Parameters of the simulated world in an experiment file: the table `sim`.

use crate::bench::element::ElementConfig;
use crate::contact::feeler_config::FeelerConfig;
use crate::objects::holder::HolderConfig;
use crate::objects::object::{MotionConfig, ObjectConfig};
use crate::objects::thread::ThreadConfig;
use crate::optics::config::OpticsConfig;
use crate::optics::error::OpticsError;
use crate::rig::arm::{self, ArmMotion};
use crate::rig::fault::FaultConfig;
use crate::rig::fault_check::FaultTargets;
use crate::rig::servo::ServoConfig;
use crate::rig::torque_sensor::TorqueSensorConfig;
use feeler::check::Checker;
use feeler::sensor::fingertip::FingertipConfig;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Maximum number of objects; far more than a hand can touch.
const MAX_OBJECTS: usize = 64;
/// Maximum number of faults; each is checked in every step.
const MAX_FAULTS: usize = 256;
/// Maximum number of physics steps per control period; with more, a run would be too slow to be useful.
const MAX_STEPS_PER_PERIOD: f64 = 1000.0;

/// Variation between runs of different seeds. Each quantity is drawn once per run from a uniform distribution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VariationConfig {
    /// Maximum offset along W's x and y of objects on a thread (m).
    pub bottle_position: f64,
    /// Maximum relative change of all friction coefficients.
    pub friction: f64,
    /// Maximum relative variation of the kinetic friction coefficients between feelers. They never exceed the static ones.
    pub kinetic_friction: f64,
    /// Maximum relative change of the seat angle.
    pub seat_angle: f64,
    /// Maximum rotation of a cap at the start (rad). It is invisible on a round cap.
    pub cap_angle: f64,
    /// Maximum offset of each joint's encoder (rad): error of the zero position that the hand assumes when it is
    /// switched on.
    pub encoder_offset: f64,
}

impl Default for VariationConfig {
    /// Variation of the reference experiment.
    fn default() -> Self {
        Self {
            bottle_position: 0.0003,
            friction: 0.05,
            kinetic_friction: 0.0,
            seat_angle: 0.05,
            cap_angle: PI,
            encoder_offset: 0.0,
        }
    }
}

/// The simulated world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimConfig {
    /// Time step of the physics (s).
    #[serde(default = "millisecond")]
    pub step: f64,
    /// Time between images of a fingertip, or between directly sensed forces (s). Set it for drives that are commanded
    /// more often than images are taken. Default: the control period.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_period: Option<f64>,
    /// Gravitational acceleration of free bodies in W (m/s²).
    #[serde(default = "earth")]
    pub gravity: [f64; 3],
    /// Motions of the arm that carries the hand; by default the hand's base is at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arm: Vec<ArmMotion>,
    /// Parameters of the feelers.
    #[serde(default)]
    pub feeler: FeelerConfig,
    /// Overrides of `feeler` for single elements.
    #[serde(default)]
    pub element: Vec<ElementConfig>,
    /// The objects, by name.
    pub object: BTreeMap<String, ObjectConfig>,
    /// The torque sensor under objects on a thread.
    #[serde(default)]
    pub torque_sensor: TorqueSensorConfig,
    /// Clamp that holds objects on a thread to the torque sensor. By default they cannot shift, and turn only with the
    /// sensor's shaft.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub holder: Option<HolderConfig>,
    /// The drives of the fingers.
    #[serde(default)]
    pub servo: ServoConfig,
    /// Variation between runs.
    #[serde(default)]
    pub variation: VariationConfig,
    /// Optics and camera of the fingertips.
    #[serde(default)]
    pub optics: OpticsConfig,
    /// Injected faults.
    #[serde(default)]
    pub fault: Vec<FaultConfig>,
    /// Noise of directly sensed forces.
    #[serde(default)]
    pub direct_sensing: DirectSensingConfig,
}

fn millisecond() -> f64 {
    1e-3
}

fn earth() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

impl SimConfig {
    /// The first object on a thread: its name, parameters and thread.
    pub fn cap(&self) -> Option<(&str, &ObjectConfig, &ThreadConfig)> {
        let mut objects = self.object.iter();
        objects.find_map(|(name, object)| Some((name.as_str(), object, object.thread()?)))
    }

    /// Checks that every value is in its range, for a hand with `fingertips` and a number of `joints`, one each per
    /// finger, and a control period of `period` seconds. Messages use the keys of an experiment file, below `sim`.
    pub fn check(
        &self,
        fingertips: &[&FingertipConfig],
        joints: &[usize],
        period: f64,
        checker: &mut Checker,
    ) {
        checker.between("sim.step", self.step, 1e-6, 0.1);
        checker.vector("sim.gravity", self.gravity);
        if let Some(frame_period) = self.frame_period {
            checker.between("sim.frame_period", frame_period, self.step, 1.0);
        }
        let turns = |object: &ObjectConfig| {
            matches!(
                object.motion,
                MotionConfig::Hinge(_) | MotionConfig::Thread(_)
            )
        };
        arm::check(&self.arm, self.object.values().any(turns), checker);
        self.servo.check("sim.servo", checker);
        self.feeler.check("sim.feeler", checker);
        for (index, exception) in self.element.iter().enumerate() {
            let feeler = exception.feeler(&self.feeler);
            feeler.check(&format!("sim.element[{index}]"), checker);
        }
        checker.require(
            "sim.object",
            format!("{} objects", self.object.len()),
            (1..=MAX_OBJECTS).contains(&self.object.len()),
            &format!("1 to {MAX_OBJECTS} objects"),
        );
        for (name, object) in &self.object {
            object.check(&format!("sim.object.{name}"), checker);
        }
        self.torque_sensor.check("sim.torque_sensor", checker);
        if let Some(holder) = &self.holder {
            holder.check("sim.holder", checker);
        }
        self.variation.check("sim.variation", checker);
        self.direct_sensing.check("sim.direct_sensing", checker);
        self.check_optics(checker);
        self.check_faults(fingertips, joints, period, checker);
        self.check_period(period, checker);
    }

    fn check_faults(
        &self,
        fingertips: &[&FingertipConfig],
        joints: &[usize],
        period: f64,
        checker: &mut Checker,
    ) {
        checker.require(
            "sim.fault",
            format!("{} faults", self.fault.len()),
            self.fault.len() <= MAX_FAULTS,
            &format!("at most {MAX_FAULTS}"),
        );
        let targets = FaultTargets {
            fingertips,
            joints,
            period,
            objects: &self.object,
        };
        for (index, fault) in self.fault.iter().enumerate() {
            fault.check(&format!("sim.fault[{index}]"), &targets, checker);
        }
    }

    fn check_optics(&self, checker: &mut Checker) {
        if let Err(OpticsError::OutOfRange {
            name,
            low,
            high,
            value,
        }) = self.optics.check()
        {
            checker.between(&format!("sim.optics.{name}"), value, low, high);
        }
    }

    fn check_period(&self, period: f64, checker: &mut Checker) {
        let steps = period / self.step;
        checker.require(
            "control.period",
            period.to_string(),
            (steps - steps.round()).abs() < 1e-6 && (0.5..=MAX_STEPS_PER_PERIOD).contains(&steps),
            &format!(
                "1 to {MAX_STEPS_PER_PERIOD} times sim.step = {}, a whole number",
                self.step
            ),
        );
    }
}

impl VariationConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.bottle_position"), self.bottle_position);
        checker.not_negative(&format!("{key}.cap_angle"), self.cap_angle);
        let most = [
            ("encoder_offset", self.encoder_offset, 1.0),
            ("friction", self.friction, 0.99),
            ("kinetic_friction", self.kinetic_friction, 0.99),
            ("seat_angle", self.seat_angle, 0.99),
        ];
        for (field, value, most) in most {
            checker.between(&format!("{key}.{field}"), value, 0.0, most);
        }
    }
}

/// Noise of directly sensed forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DirectSensingConfig {
    /// Standard deviation of an element's normal force (N).
    pub normal_noise: f64,
    /// Standard deviation of each component of an element's shear force (N).
    pub shear_noise: f64,
}

impl Default for DirectSensingConfig {
    /// Approximately the noise of forces from images of the reference fingertip.
    fn default() -> Self {
        Self {
            normal_noise: 0.002,
            shear_noise: 0.002,
        }
    }
}

impl DirectSensingConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.normal_noise"), self.normal_noise);
        checker.not_negative(&format!("{key}.shear_noise"), self.shear_noise);
    }
}
