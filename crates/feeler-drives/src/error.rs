//! Why a hand of servos does not move, or stopped.

use crate::bus::BusError;
use feeler::check::Problem;
use std::fmt;

/// A joint, and the servo that moves it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointName {
    /// The finger, from 0.
    pub finger: usize,
    /// The joint: theta1 is 0.
    pub joint: usize,
    /// The servo's id.
    pub id: u8,
}

impl fmt::Display for JointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { finger, joint, id } = self;
        write!(f, "servo {id} (theta{} of finger {finger})", joint + 1)
    }
}

/// Why a hand of servos does not move, or stopped.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The table `[drives]` has values out of their ranges.
    #[error("{}", list(.0))]
    Config(Vec<Problem>),
    /// The bus fails, whichever servo was asked.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A servo does not answer as it should.
    #[error("theta{} of finger {}: {source}", joint.joint + 1, joint.finger)]
    Servo {
        /// The joint that it moves.
        joint: JointName,
        /// What is wrong.
        source: BusError,
    },
    /// Another model than the file says.
    #[error("{joint} says that it is model {actual}: expected {expected}, a {name}")]
    Model {
        /// The joint.
        joint: JointName,
        /// Model number by the file.
        expected: i64,
        /// Its name.
        name: &'static str,
        /// Model number by the servo.
        actual: i64,
    },
    /// A servo's firmware is too old for what the file asks for.
    #[error(
        "{joint} has firmware {actual}: expected {expected} or newer for fast_sync_read = true; renew it with the vendor's program, or set fast_sync_read = false"
    )]
    Firmware {
        /// The joint.
        joint: JointName,
        /// The first firmware that will do.
        expected: i64,
        /// What it has.
        actual: i64,
    },
    /// A servo allows less speed than the joint is to have.
    #[error(
        "{joint} turns at most at {actual:.2} rad/s as it is set: expected {expected:.2} rad/s, joint_speed_limit times gear_ratio"
    )]
    VelocityLimit {
        /// The joint.
        joint: JointName,
        /// What it takes, rad/s at the servo.
        expected: f64,
        /// What the servo allows, rad/s.
        actual: f64,
    },
    /// A servo does not keep what was written.
    #[error("{joint} has {name} = {actual} after {expected} was written to it")]
    NotSet {
        /// The joint.
        joint: JointName,
        /// What was written.
        name: &'static str,
        /// What it should be.
        expected: i64,
        /// What it is.
        actual: i64,
    },
    /// A servo says that it has a fault.
    #[error(
        "{joint} reports a fault: {faults} ({bits:#04x}); when its cause is gone, switch its supply off and on"
    )]
    Fault {
        /// The joint.
        joint: JointName,
        /// The faults in words.
        faults: String,
        /// The bits.
        bits: u8,
    },
    /// A servo is too hot.
    #[error(
        "{joint} has {actual} degrees Celsius: at most {limit} expected (temperature_limit_celsius)"
    )]
    Temperature {
        /// The joint.
        joint: JointName,
        /// Its temperature, degrees Celsius.
        actual: f64,
        /// The limit, degrees Celsius.
        limit: f64,
    },
    /// A servo's supply is too low or too high.
    #[error("{joint} is supplied with {actual:.1} V: {low} to {high} V expected (voltage_range)")]
    Voltage {
        /// The joint.
        joint: JointName,
        /// Its voltage, V.
        actual: f64,
        /// The least, V.
        low: f64,
        /// The most, V.
        high: f64,
    },
    /// A motor has no power though it was given some.
    #[error("{joint} has its torque off: it was restarted, or somebody switched it off")]
    TorqueOff {
        /// The joint.
        joint: JointName,
    },
    /// A servo's watchdog stopped its motor.
    #[error(
        "the bus watchdog of {joint} is {actual} instead of {expected}: it heard nothing for too long, or was restarted"
    )]
    Watchdog {
        /// The joint.
        joint: JointName,
        /// What was written, 20 ms.
        expected: i64,
        /// What it is; -1 once it has stopped the motor.
        actual: i64,
    },
    /// A joint is beyond its limits.
    #[error("{joint} is at {angle:.4} rad: {lower:.4} to {upper:.4} rad expected")]
    BeyondLimits {
        /// The joint.
        joint: JointName,
        /// Its angle, rad.
        angle: f64,
        /// Its lower limit, rad.
        lower: f64,
        /// Its upper limit, rad.
        upper: f64,
    },
    /// A joint seems to turn faster than it can.
    #[error("{joint} turns at {velocity:.2} rad/s: at most {limit:.2} rad/s expected")]
    TooFast {
        /// The joint.
        joint: JointName,
        /// Its velocity, rad/s.
        velocity: f64,
        /// What is possible, rad/s.
        limit: f64,
    },
    /// The command is not made of fresh joint angles.
    #[error(
        "the joint angles that the command was made of are {age:.4} s old: at most {limit:.4} s expected"
    )]
    Stale {
        /// Age of the newest, s.
        age: f64,
        /// Most allowed, s.
        limit: f64,
    },
    /// A command that no servo can follow.
    #[error("{joint} was to turn at {velocity} rad/s: at most {limit:.2} rad/s expected")]
    Command {
        /// The joint.
        joint: JointName,
        /// The velocity, rad/s.
        velocity: f64,
        /// The limit, rad/s.
        limit: f64,
    },
    /// A hand that a fault has stopped.
    #[error("it was stopped before, and stays so until it is restarted: {fault}")]
    Stopped {
        /// What stopped it.
        fault: String,
    },
    /// There is no such joint.
    #[error(
        "finger {finger} and joint {joint}: expected a finger from 0 on that the hand has, and theta1 to theta3"
    )]
    NoJoint {
        /// The finger, from 0.
        finger: usize,
        /// The joint, from 1.
        joint: usize,
    },
}

fn list(problems: &[Problem]) -> String {
    let problems: Vec<_> = problems.iter().map(ToString::to_string).collect();
    problems.join("; ")
}
