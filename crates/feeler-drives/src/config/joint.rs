//! The servo of a joint.

use crate::registers::{DriveMode, Model};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Maximum speed of a jogged revolute joint, rad/s.
const JOG_SPEED: f64 = 10_f64.to_radians();
/// Maximum speed of a jogged prismatic joint, m/s.
const PRISMATIC_JOG_SPEED: f64 = 0.01;

/// The servo of a joint. Joint angle = `direction` * servo angle / `gear_ratio` + `homing_offset`. Displacement of a
/// prismatic joint = `direction` * turns of the servo * `travel_per_turn` + `homing_offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointDriveConfig {
    /// Id on the bus.
    pub id: u8,
    /// `true` if the servo of an earlier finger, of the same `id`, also moves this joint, as in a gripper with one
    /// motor for both jaws. Only `id`, `direction`, the transmission and `homing_offset` are then set here.
    #[serde(default, skip_serializing_if = "is_false")]
    pub shared: bool,
    /// Servo model, e.g. `XL330-M288`. Empty if `shared`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub model: String,
    /// Mode in which the servo follows the joint's velocity; velocity mode if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<DriveMode>,
    /// Joint angle (rad) or displacement (m) at servo position 0; determined by `feeler drives home`.
    #[serde(default)]
    pub homing_offset: f64,
    /// 1, or -1 if the joint's position decreases when the servo's position increases.
    #[serde(default = "forward")]
    pub direction: i8,
    /// Turns of the servo's horn per turn of the joint; 1 for a prismatic joint.
    #[serde(default = "one")]
    pub gear_ratio: f64,
    /// Travel of a prismatic joint per turn of the servo's horn, m: the lead of a screw, or the circumference of a
    /// pinion's pitch circle. `None` for a revolute joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel_per_turn: Option<f64>,
    /// Maximum distance between measured and goal position in the position modes (rad or m). If `None`, the joint's
    /// speed limit times the maximum age of joint angles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leash: Option<f64>,
    /// Maximum current, A; if `None`, the servo's own setting. Current-limited position mode requires it or
    /// `torque_limit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub current_limit: Option<f64>,
    /// Maximum torque of the motor at the joint, N m (N for a prismatic joint), in current-limited position mode; requires
    /// `torque`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_limit: Option<f64>,
    /// Calibration of the torque; determined by `feeler drives identify-current`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque: Option<TorqueCalibration>,
}

/// Calibration of a joint's torque: `constant` times the motor's current, minus `friction` if the joint moves; in N m,
/// or N for a prismatic joint. Errors are standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueCalibration {
    /// Torque per current, N m/A or N/A.
    pub constant: f64,
    /// Standard error of `constant`.
    pub constant_error: f64,
    /// Coulomb friction, N m or N.
    pub friction: f64,
    /// Standard error of `friction`.
    pub friction_error: f64,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

fn forward() -> i8 {
    1
}

fn one() -> f64 {
    1.0
}

impl JointDriveConfig {
    /// Mode in which the servo follows the joint's velocity.
    pub fn mode(&self) -> DriveMode {
        self.mode.unwrap_or_default()
    }

    /// Converts the angle of the servo's horn (rad) to the joint's position, rad or m.
    pub fn position(&self, horn: f64) -> f64 {
        self.turn(horn) + self.homing_offset
    }

    /// Converts a rotation of the servo's horn (rad) to a change of the joint's position, rad or m.
    pub fn turn(&self, horn: f64) -> f64 {
        f64::from(self.direction) * horn / self.transmission()
    }

    /// Converts the joint's position (rad or m) to the angle of the servo's horn, rad.
    pub fn horn(&self, position: f64) -> f64 {
        f64::from(self.direction) * (position - self.homing_offset) * self.transmission()
    }

    /// Converts the joint's velocity (rad/s or m/s) to the servo's velocity, rad/s.
    pub fn servo_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity * self.transmission()
    }

    /// Converts the servo's velocity (rad/s) to the joint's velocity, rad/s or m/s.
    pub fn joint_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity / self.transmission()
    }

    /// Motion of this joint (rad or m) per motion of the joint of `other` (rad or m), if the same servo moves both.
    pub fn ratio_to(&self, other: &Self) -> f64 {
        self.joint_velocity(other.servo_velocity(1.0))
    }

    /// Rotation of the servo's horn (rad) per rad or m of the joint's motion.
    pub fn transmission(&self) -> f64 {
        match self.travel_per_turn {
            None => self.gear_ratio,
            Some(travel) => TAU / travel,
        }
    }

    /// Unit of the joint's position: `rad`, or `m` for a prismatic joint.
    pub fn unit(&self) -> &'static str {
        match self.travel_per_turn {
            None => "rad",
            Some(_) => "m",
        }
    }

    /// Unit of the joint's effort: `N m`, or `N` for a prismatic joint.
    pub fn effort_unit(&self) -> &'static str {
        match self.travel_per_turn {
            None => "N m",
            Some(_) => "N",
        }
    }

    /// Maximum speed of the joint when jogged: 0.2 rad/s, or 0.01 m/s for a prismatic joint.
    pub fn jog_speed(&self) -> f64 {
        match self.travel_per_turn {
            None => JOG_SPEED,
            Some(_) => PRISMATIC_JOG_SPEED,
        }
    }

    /// Maximum current in current-limited position mode, A: `current_limit`, or less due to `torque_limit`. `None` if
    /// the joint has neither limit.
    pub fn most_current(&self) -> Option<f64> {
        let by_torque = match (self.torque_limit, self.torque) {
            (Some(limit), Some(torque)) => Some(limit / torque.constant),
            _ => None,
        };
        match (self.current_limit, by_torque) {
            (Some(limit), Some(other)) => Some(limit.min(other)),
            (limit, other) => limit.or(other),
        }
    }

    /// The model of the servo, or `None` if it is unknown.
    pub fn known_model(&self) -> Option<&'static Model> {
        Model::named(&self.model)
    }
}
