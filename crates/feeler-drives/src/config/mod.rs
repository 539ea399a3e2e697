//! The table `[drives]` of an experiment file.

mod check;
mod check_joint;
mod joint;
mod shared;
mod timing;

pub use joint::{JointDriveConfig, TorqueCalibration};

use crate::packet::Protocol;
use crate::registers::{DriveMode, WATCHDOG_UNIT};
use feeler::hand::JointCoupling;
use serde::{Deserialize, Serialize};

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
    /// Reads all servos with a single response packet (Dynamixel X330 with firmware 46 or newer, X430 with 45). Not
    /// supported by Feetech servos; those of the SCS series are read one after the other.
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
    /// Temperature of a servo above which the hand stops, degrees Celsius.
    #[serde(default = "seventy")]
    pub temperature_limit_celsius: f64,
    /// Minimum and maximum supply voltage, V; a voltage outside stops the hand.
    #[serde(default = "usual_voltage")]
    pub voltage_range: [f64; 2],
    /// Distance beyond a joint limit at which the hand stops, in rad. For a prismatic joint, this value times the
    /// finger's reach, in m.
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

impl DrivesConfig {
    /// Configuration for the emulator, for a hand without a table `[drives]`: ids from 1, 4 Mbaud, gear ratio 5, and
    /// 40 mm of travel per turn. `prismatic` has an entry per joint of each finger: `true` if the joint is prismatic.
    pub fn emulated(prismatic: &[Vec<bool>]) -> Self {
        let joint = |(&slides, id): (&bool, u8)| JointDriveConfig {
            id,
            shared: false,
            model: "XL330-M077".into(),
            mode: None,
            homing_offset: 0.0,
            direction: 1,
            gear_ratio: if slides { 1.0 } else { 5.0 },
            travel_per_turn: slides.then_some(0.04),
            leash: None,
            current_limit: None,
            torque_limit: None,
            torque: None,
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

    /// All joints with their servos, finger by finger, joint by joint.
    pub fn joints(&self) -> impl Iterator<Item = &JointDriveConfig> {
        self.finger.iter().flat_map(|finger| &finger.joint)
    }

    /// All servos, each with the first joint that it moves.
    pub fn servos(&self) -> impl Iterator<Item = &JointDriveConfig> {
        self.joints().filter(|joint| !joint.shared)
    }

    /// Joints of later fingers that are moved by the servo of another joint.
    pub fn couplings(&self) -> Vec<JointCoupling> {
        let joints = || {
            let fingers = self.finger.iter().enumerate();
            fingers.flat_map(|(finger, drives)| {
                let joints = drives.joint.iter().enumerate();
                joints.map(move |(joint, drive)| ((finger, joint), drive))
            })
        };
        let shared = joints().filter(|(_, drive)| drive.shared);
        let coupling = |(other, drive): (_, &JointDriveConfig)| {
            let (first, own) = joints().find(|(_, own)| own.id == drive.id && !own.shared)?;
            Some(JointCoupling {
                first,
                other,
                ratio: drive.ratio_to(own),
            })
        };
        shared.filter_map(coupling).collect()
    }

    /// Returns `true` if any joint has a torque calibration, so that its effort is estimated from the current.
    pub fn measures_efforts(&self) -> bool {
        self.joints().any(|joint| joint.torque.is_some())
    }

    /// Returns `true` if the currents of the servos are read in every period: if a joint has a torque calibration or a
    /// limited current.
    pub fn reads_current(&self) -> bool {
        let is_limited = |mode| mode == DriveMode::CurrentLimitedPosition;
        self.measures_efforts() || self.joints().any(|joint| is_limited(joint.mode()))
    }

    /// Bus watchdog in the servos' unit of 20 ms, rounded up.
    pub fn watchdog_counts(&self) -> i64 {
        (self.bus_watchdog / WATCHDOG_UNIT - 1e-9).ceil() as i64
    }
}
