//! The table `[drives]` of an experiment file.

mod check;

use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Model, WATCHDOG_UNIT};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Maximum speed of a jogged revolute joint, rad/s.
pub const JOG_SPEED: f64 = 0.2;
/// Maximum speed of a jogged prismatic joint, m/s.
pub const PRISMATIC_JOG_SPEED: f64 = 0.01;

/// Servos of the hand, and their bus.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivesConfig {
    /// Serial port, e.g. `/dev/ttyUSB0`. A persistent name as under `/dev/serial/by-id` is preferable.
    pub port: String,
    /// Baud rate configured in the servos.
    #[serde(default = "a_megabaud")]
    pub baud_rate: u32,
    /// Protocol of the servos.
    #[serde(default = "dynamixel")]
    pub protocol: Protocol,
    /// Reads all servos by a single response packet (Dynamixel X330 with firmware 46 or newer, X430 with 45). Not
    /// supported by Feetech servos.
    #[serde(default)]
    pub fast_sync_read: bool,
    /// Time without instructions after which a servo stops its motor, s, in steps of 0.02 s. Feetech servos have no
    /// watchdog: 0 confirms that their motors keep running if the computer fails.
    pub bus_watchdog: f64,
    /// Time allowed for a response in addition to its transmission time, s.
    #[serde(default = "ten_milliseconds")]
    pub reply_timeout: f64,
    /// Interval at which temperature, voltage, torque and watchdog are read, from one servo after the other, s. Feetech
    /// servos report temperature and voltage in every period.
    #[serde(default = "twenty_milliseconds")]
    pub health_interval: f64,
    /// Temperature above which a servo stops the hand, degrees Celsius.
    #[serde(default = "seventy")]
    pub temperature_limit_celsius: f64,
    /// Minimum and maximum supply voltage, V; a voltage outside stops the hand.
    #[serde(default = "usual_voltage")]
    pub voltage_range: [f64; 2],
    /// Angle beyond a joint limit that stops the hand, rad; multiplied by the finger's reach (m) for a prismatic joint.
    #[serde(default = "three_degrees")]
    pub limit_tolerance: f64,
    /// Servos of each finger, in the order of `hand.finger`.
    #[serde(default)]
    pub finger: Vec<FingerDrivesConfig>,
}

/// The servos of one finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerDrivesConfig {
    /// Servos of the finger's joints, from the base to the fingertip.
    pub joint: Vec<JointDriveConfig>,
}

/// The servo of one joint. Joint angle = `direction` * servo angle / `gear_ratio` + `homing_offset`. Displacement of a
/// prismatic joint = `direction` * turns of the servo * `travel_per_turn` + `homing_offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointDriveConfig {
    /// Id on the bus.
    pub id: u8,
    /// Servo model, e.g. `XL330-M288`.
    pub model: String,
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
    /// Maximum current, A; if `None`, the servo's own setting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub current_limit: Option<f64>,
}

fn a_megabaud() -> u32 {
    1_000_000
}

fn dynamixel() -> Protocol {
    Protocol::Dynamixel
}

fn ten_milliseconds() -> f64 {
    0.01
}

fn twenty_milliseconds() -> f64 {
    0.02
}

fn seventy() -> f64 {
    70.0
}

fn usual_voltage() -> [f64; 2] {
    [4.0, 13.0]
}

fn three_degrees() -> f64 {
    0.05
}

fn forward() -> i8 {
    1
}

fn one() -> f64 {
    1.0
}

impl JointDriveConfig {
    /// Converts the servo's position in counts to the joint's position, rad or m.
    pub fn angle(&self, counts: f64) -> f64 {
        self.turn(counts) + self.homing_offset
    }

    /// Converts a change of the servo's position in counts to a change of the joint's position, rad or m.
    pub fn turn(&self, counts: f64) -> f64 {
        f64::from(self.direction) * counts * TAU / COUNTS_PER_TURN / self.transmission()
    }

    /// Converts the joint's position (rad or m) to the servo's position in counts.
    pub fn counts(&self, angle: f64) -> f64 {
        let turn = angle - self.homing_offset;
        f64::from(self.direction) * turn * COUNTS_PER_TURN / TAU * self.transmission()
    }

    /// Converts the joint's velocity (rad/s or m/s) to the servo's velocity, rad/s.
    pub fn servo_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity * self.transmission()
    }

    /// Converts the servo's velocity (rad/s) to the joint's velocity, rad/s or m/s.
    pub fn joint_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity / self.transmission()
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

    /// Maximum speed of the joint when jogged: [`JOG_SPEED`], or [`PRISMATIC_JOG_SPEED`] for a prismatic joint.
    pub fn jog_speed(&self) -> f64 {
        match self.travel_per_turn {
            None => JOG_SPEED,
            Some(_) => PRISMATIC_JOG_SPEED,
        }
    }

    /// The model of the servo, or `None` if it is unknown.
    pub fn known_model(&self) -> Option<&'static Model> {
        Model::named(&self.model)
    }
}

impl DrivesConfig {
    /// Configuration for the emulator, for a hand without a table `[drives]`: ids from 1, 4 Mbaud, gear ratio 5, and
    /// 40 mm of travel per turn. `prismatic` has an entry per joint of each finger: `true` if the joint is prismatic.
    pub fn emulated(prismatic: &[Vec<bool>]) -> Self {
        let joint = |(&slides, id): (&bool, u8)| JointDriveConfig {
            id,
            model: "XL330-M077".into(),
            homing_offset: 0.0,
            direction: 1,
            gear_ratio: if slides { 1.0 } else { 5.0 },
            travel_per_turn: slides.then_some(0.04),
            current_limit: None,
        };
        let mut ids = 1..;
        let finger = |joints: &Vec<bool>| FingerDrivesConfig {
            joint: joints.iter().zip(ids.by_ref()).map(joint).collect(),
        };
        Self {
            port: "emulated".into(),
            baud_rate: 4_000_000,
            protocol: Protocol::Dynamixel,
            fast_sync_read: true,
            bus_watchdog: 0.1,
            // The emulator runs on a thread of a possibly busy computer.
            reply_timeout: 0.1,
            health_interval: twenty_milliseconds(),
            temperature_limit_celsius: seventy(),
            voltage_range: usual_voltage(),
            limit_tolerance: three_degrees(),
            finger: prismatic.iter().map(finger).collect(),
        }
    }

    /// All servos, finger by finger, joint by joint.
    pub fn joints(&self) -> impl Iterator<Item = &JointDriveConfig> {
        self.finger.iter().flat_map(|finger| &finger.joint)
    }

    /// Bus watchdog in the servos' unit of 20 ms, rounded up.
    pub fn watchdog_counts(&self) -> i64 {
        (self.bus_watchdog / WATCHDOG_UNIT - 1e-9).ceil() as i64
    }
}
