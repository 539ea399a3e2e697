//! The table `[drives]` of an experiment file.

mod check;

use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Model, WATCHDOG_UNIT};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The servos that move the hand, and the bus that they are on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivesConfig {
    /// Serial port, e.g. `/dev/ttyUSB0`; better a name that stays, as under `/dev/serial/by-id`.
    pub port: String,
    /// Bits a second, as the servos are set.
    #[serde(default = "a_megabaud")]
    pub baud_rate: u32,
    /// What the servos speak.
    #[serde(default = "dynamixel")]
    pub protocol: Protocol,
    /// Whether all servos answer in one packet (Dynamixel X330 with firmware 46 or newer, X430 with 45). Feetech servos cannot.
    #[serde(default)]
    pub fast_sync_read: bool,
    /// A servo stops its motor by itself when it hears nothing for so long, s, in steps of 0.02 s. Feetech servos cannot: 0 says that
    /// whoever wrote it knows that their motors go on when the computer dies.
    pub bus_watchdog: f64,
    /// A servo that has not answered within this time beyond what the bytes take fails, s.
    #[serde(default = "ten_milliseconds")]
    pub reply_timeout: f64,
    /// How often one of the servos, by turns, is asked for temperature, voltage, torque and watchdog, s. Feetech servos say them
    /// in every period.
    #[serde(default = "twenty_milliseconds")]
    pub health_interval: f64,
    /// A hotter servo stops the hand, degrees Celsius.
    #[serde(default = "seventy")]
    pub temperature_limit_celsius: f64,
    /// A lower or higher supply voltage stops the hand, V.
    #[serde(default = "usual_voltage")]
    pub voltage_range: [f64; 2],
    /// A joint that is so far beyond its limits stops the hand, rad.
    #[serde(default = "three_degrees")]
    pub limit_tolerance: f64,
    /// The joints of each finger, in the order of `hand.finger`.
    #[serde(default)]
    pub finger: Vec<FingerDrivesConfig>,
}

/// The servos of one finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerDrivesConfig {
    /// Those of theta1, theta2, theta3.
    pub joint: Vec<JointDriveConfig>,
}

/// The servo of one joint. Joint angle = `direction` * servo angle / `gear_ratio` + `homing_offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointDriveConfig {
    /// Its id on the bus.
    pub id: u8,
    /// Its model, e.g. `XL330-M288`.
    pub model: String,
    /// Joint angle where the servo's position is 0, rad; `feeler drives home` finds it.
    #[serde(default)]
    pub homing_offset: f64,
    /// 1, or -1 where the joint angle falls when the servo's position rises.
    #[serde(default = "forward")]
    pub direction: i8,
    /// Turns of the servo's horn in a turn of the joint.
    #[serde(default = "one")]
    pub gear_ratio: f64,
    /// Largest current, A; without it, as the servo is set.
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
    /// Joint angle, rad, at the servo's position `counts`.
    pub fn angle(&self, counts: f64) -> f64 {
        self.turn(counts) + self.homing_offset
    }

    /// By how much the joint turns, rad, where the servo turns by `counts`.
    pub fn turn(&self, counts: f64) -> f64 {
        f64::from(self.direction) * counts * TAU / COUNTS_PER_TURN / self.gear_ratio
    }

    /// The servo's position, counts, at the joint angle `angle`, rad.
    pub fn counts(&self, angle: f64) -> f64 {
        let turn = angle - self.homing_offset;
        f64::from(self.direction) * turn * COUNTS_PER_TURN / TAU * self.gear_ratio
    }

    /// The servo's angular velocity, rad/s, at the joint's `velocity`, rad/s.
    pub fn servo_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity * self.gear_ratio
    }

    /// The joint's angular velocity, rad/s, at the servo's `velocity`, rad/s.
    pub fn joint_velocity(&self, velocity: f64) -> f64 {
        f64::from(self.direction) * velocity / self.gear_ratio
    }

    /// The model of the servo, if it is known.
    pub fn known_model(&self) -> Option<&'static Model> {
        Model::named(&self.model)
    }
}

impl DrivesConfig {
    /// The emulator's stand-in for a hand of so many `fingers` that has no table of its own: ids from 1 on, at 4 Mbaud, with a
    /// gear of 5 between servo and joint.
    pub fn emulated(fingers: usize) -> Self {
        let joint = |id: usize| JointDriveConfig {
            id: id as u8,
            model: "XL330-M077".into(),
            homing_offset: 0.0,
            direction: 1,
            gear_ratio: 5.0,
            current_limit: None,
        };
        let finger = |finger: usize| FingerDrivesConfig {
            joint: (1..=3).map(|theta| joint(3 * finger + theta)).collect(),
        };
        Self {
            port: "emulated".into(),
            baud_rate: 4_000_000,
            protocol: Protocol::Dynamixel,
            fast_sync_read: true,
            bus_watchdog: 0.1,
            // What plays the servos is a thread of a computer that may be busy.
            reply_timeout: 0.1,
            health_interval: twenty_milliseconds(),
            temperature_limit_celsius: seventy(),
            voltage_range: usual_voltage(),
            limit_tolerance: three_degrees(),
            finger: (0..fingers).map(finger).collect(),
        }
    }

    /// The servos, finger by finger, joint by joint.
    pub fn joints(&self) -> impl Iterator<Item = &JointDriveConfig> {
        self.finger.iter().flat_map(|finger| &finger.joint)
    }

    /// Watchdog of the servos in their unit of 20 ms, rounded up.
    pub fn watchdog_counts(&self) -> i64 {
        (self.bus_watchdog / WATCHDOG_UNIT - 1e-9).ceil() as i64
    }
}
