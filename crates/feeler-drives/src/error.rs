//! Errors of a hand of servos.

use crate::bus::BusError;
use feeler::check::{Problem, joined};
use feeler::hand::FingerGeometry;
use std::fmt;

/// A joint and the id of its servo, which may move further joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointName {
    /// Finger, from 0.
    pub finger: usize,
    /// Joint, from 0 for theta1.
    pub joint: usize,
    /// Id of the servo.
    pub id: u8,
}

impl fmt::Display for JointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { finger, joint, id } = self;
        write!(f, "servo {id} (theta{} of finger {finger})", joint + 1)
    }
}

/// Warning after an error that may have left motors powered.
pub const TORQUE_MAY_BE_ON: &str = "torque may still be enabled: switch off the servos' supply";

/// Error of a hand of servos.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// Values of the table `[drives]` are out of range.
    #[error("{}", joined(.0))]
    Config(Vec<Problem>),
    /// The bus failed, independently of a servo.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// Communication with a servo failed.
    #[error("theta{} of finger {}: {source}", joint.joint + 1, joint.finger)]
    Servo {
        /// Joint of the servo.
        joint: JointName,
        /// Error of the bus.
        source: BusError,
    },
    /// The model of a servo differs from the configuration.
    #[error("{joint} reports model {actual}: expected {expected} ({name})")]
    Model {
        /// The joint.
        joint: JointName,
        /// Configured model number.
        expected: i64,
        /// Name of the configured model.
        name: &'static str,
        /// Model number reported by the servo.
        actual: i64,
    },
    /// A servo's firmware is too old for the configuration.
    #[error(
        "{joint} has firmware {actual}: expected {expected} or newer for fast_sync_read = true; update it with the manufacturer's program, or set fast_sync_read = false"
    )]
    Firmware {
        /// The joint.
        joint: JointName,
        /// Minimum firmware version for the setting.
        expected: i64,
        /// Firmware version of the servo.
        actual: i64,
    },
    /// A servo's velocity limit is below the joint's speed limit.
    #[error(
        "{joint} is limited to {actual:.3} rad/s: expected at least {expected:.3} rad/s, joint_speed_limit times gear_ratio, or times 2 pi / travel_per_turn; raise the servo's limit, or lower joint_speed_limit"
    )]
    VelocityLimit {
        /// The joint.
        joint: JointName,
        /// Required velocity of the servo, rad/s.
        expected: f64,
        /// Velocity limit of the servo, rad/s.
        actual: f64,
    },
    /// A servo did not store a value.
    #[error("{joint} has {name} = {actual} after {expected} was written")]
    NotSet {
        /// The joint.
        joint: JointName,
        /// Name of the value.
        name: &'static str,
        /// Value written.
        expected: i64,
        /// Value read back.
        actual: i64,
    },
    /// A servo reports a fault.
    #[error(
        "{joint} reports a fault: {faults} ({bits:#04x}); remove the cause, then switch its supply off and on"
    )]
    Fault {
        /// The joint.
        joint: JointName,
        /// Description of the faults.
        faults: String,
        /// Fault bits.
        bits: u8,
    },
    /// A servo is too hot.
    #[error(
        "{joint} is at {actual} degrees Celsius: expected at most {limit} (temperature_limit_celsius)"
    )]
    Temperature {
        /// The joint.
        joint: JointName,
        /// Temperature, degrees Celsius.
        actual: f64,
        /// Maximum temperature, degrees Celsius.
        limit: f64,
    },
    /// A servo's supply voltage is out of range.
    #[error("{joint} is supplied with {actual:.1} V: expected {low} to {high} V (voltage_range)")]
    Voltage {
        /// The joint.
        joint: JointName,
        /// Supply voltage, V.
        actual: f64,
        /// Minimum voltage, V.
        low: f64,
        /// Maximum voltage, V.
        high: f64,
    },
    /// A motor's torque is off although it was switched on.
    #[error("{joint} has its torque off: it was restarted, or another program switched it off")]
    TorqueOff {
        /// The joint.
        joint: JointName,
    },
    /// A servo's watchdog stopped its motor.
    #[error(
        "the bus watchdog of {joint} is {actual} instead of {expected}: it received nothing for too long, or was restarted"
    )]
    Watchdog {
        /// The joint.
        joint: JointName,
        /// Value written, in units of 20 ms.
        expected: i64,
        /// Value read, in units of 20 ms; -1 after the watchdog has stopped the motor.
        actual: i64,
    },
    /// A joint is beyond its limits.
    #[error("{joint} is at {angle:.4} {unit}: expected {lower:.4} to {upper:.4} {unit}")]
    BeyondLimits {
        /// The joint.
        joint: JointName,
        /// Joint angle, rad, or displacement, m.
        angle: f64,
        /// Lower limit, rad or m.
        lower: f64,
        /// Upper limit, rad or m.
        upper: f64,
        /// Unit: `rad` or `m`.
        unit: &'static str,
    },
    /// No position of a servo is within the limits of all joints that it moves.
    #[error(
        "{joint}: expected a range in common with theta{} of finger {}, whose limits correspond to {lower:.4} to {upper:.4} {unit}; home the hand, or check direction and travel of both joints", other.joint + 1, other.finger
    )]
    NoCommonRange {
        /// First joint of the servo.
        joint: JointName,
        /// Joint that shares the servo.
        other: JointName,
        /// Lower limit of `other`, converted to `joint` (rad or m).
        lower: f64,
        /// Upper limit of `other`, converted to `joint` (rad or m).
        upper: f64,
        /// Unit: `rad` or `m`.
        unit: &'static str,
    },
    /// A servo lost count of its turns when it restarted.
    #[error(
        "{joint} is at {angle:.4} {unit}, more than half a turn of the servo from its last position {before:.4} {unit}: it restarted in another turn, or was moved; home the hand again, then restart the program"
    )]
    TurnLost {
        /// The joint.
        joint: JointName,
        /// Position before the restart, rad or m.
        before: f64,
        /// Position after the restart, rad or m.
        angle: f64,
        /// Unit: `rad` or `m`.
        unit: &'static str,
    },
    /// The range of a joint crosses the position at which its servo wraps.
    #[error(
        "{joint} has positions from {lower} to {upper} counts: expected a range within one turn (0 to 4095) for position mode; set the servo's position correction (address 31) so that the middle of the range is near 2048, then home the hand again"
    )]
    Wraps {
        /// The joint.
        joint: JointName,
        /// Minimum position of the joint's range, counts.
        lower: i64,
        /// Maximum position of the joint's range, counts.
        upper: i64,
    },
    /// The range of a joint is beyond the positions of its servo.
    #[error(
        "{joint} has positions from {lower} to {upper} counts: expected a range within 0 to {most}; turn its horn on the shaft so that the middle of the range is near {}, then home the hand again", (most + 1) / 2
    )]
    OutOfReach {
        /// The joint.
        joint: JointName,
        /// Minimum position of the joint's range, counts.
        lower: i64,
        /// Maximum position of the joint's range, counts.
        upper: i64,
        /// Maximum position of the servo, counts.
        most: i64,
    },
    /// A servo does not allow the current of current-limited position mode.
    #[error(
        "{joint} allows at most {actual:.3} A (Current Limit, address {address}): expected at least {expected:.3} A by torque_limit or current_limit; lower torque_limit, or set current_limit, which is written to the servo"
    )]
    CurrentLimit {
        /// The joint.
        joint: JointName,
        /// Required current, A.
        expected: f64,
        /// Maximum current of the servo, A.
        actual: f64,
        /// Address of the maximum current in the servo's control table.
        address: u16,
    },
    /// The adapter delivers responses late.
    #[error(
        "the adapter delivers responses after {latency:.4} s, so joint angles are older than they appear: expected at most {limit:.4} s; set its latency timer to 1 ms (docs/your-rig.md#1-permissions)"
    )]
    SlowAdapter {
        /// Time from the end of a response on the bus to its delivery, s.
        latency: f64,
        /// Maximum time, s.
        limit: f64,
    },
    /// A joint appears to move faster than possible.
    #[error("{joint} moves at {velocity:.2} {unit}/s: expected at most {limit:.2} {unit}/s")]
    TooFast {
        /// The joint.
        joint: JointName,
        /// Measured velocity, rad/s or m/s.
        velocity: f64,
        /// Maximum plausible velocity, rad/s or m/s.
        limit: f64,
        /// Unit: `rad` or `m`.
        unit: &'static str,
    },
    /// The joint angles that a command is based on are too old.
    #[error("the joint angles for the command are {age:.4} s old: expected at most {limit:.4} s")]
    Stale {
        /// Age of the latest joint angles, s.
        age: f64,
        /// Maximum age, s.
        limit: f64,
    },
    /// A command exceeds a joint's speed limit.
    #[error(
        "{joint} was commanded to move at {velocity} {unit}/s: expected at most {limit:.2} {unit}/s"
    )]
    Command {
        /// The joint.
        joint: JointName,
        /// Commanded velocity, rad/s or m/s.
        velocity: f64,
        /// Speed limit, rad/s or m/s.
        limit: f64,
        /// Unit: `rad` or `m`.
        unit: &'static str,
    },
    /// The hand remains stopped after a fault.
    #[error("the hand was stopped by a fault and remains stopped until it is restarted: {fault}")]
    Stopped {
        /// Message of the fault.
        fault: String,
    },
    /// An error, after which not every servo has confirmed that its torque is off.
    #[error("{0}; {words}", words = TORQUE_MAY_BE_ON)]
    TorqueMayBeOn(Box<DriveError>),
    /// The hand has no such joint.
    #[error(
        "finger {finger} and joint {joint}: expected a finger of the hand (from 0) and {}", thetas(*joints)
    )]
    NoJoint {
        /// Finger, from 0.
        finger: usize,
        /// Joint, from 1.
        joint: usize,
        /// Number of joints of the finger, or of the first one if there is no such finger.
        joints: usize,
    },
}

impl DriveError {
    /// Returns the error for the joint with the index `joint` (from 0) of `finger`, which a hand with these `fingers`
    /// does not have.
    pub fn no_joint(finger: usize, joint: usize, fingers: &[FingerGeometry]) -> Self {
        let known = fingers.get(finger).or_else(|| fingers.first());
        Self::NoJoint {
            finger,
            joint: joint + 1,
            joints: known.map_or(0, FingerGeometry::joint_count),
        }
    }
}

/// Names of the joints of a finger with this number of joints, for messages.
pub(crate) fn thetas(joints: usize) -> String {
    match joints {
        0 | 1 => "theta1".into(),
        joints => format!("theta1 to theta{joints}"),
    }
}
