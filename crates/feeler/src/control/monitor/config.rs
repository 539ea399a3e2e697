//! Thresholds of the plausibility checks of joint and tactile sensors.

use crate::check::Checker;
use serde::{Deserialize, Serialize};

/// Thresholds for detecting implausible sensor data. 0 disables a check.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MonitorConfig {
    /// Maximum deviation of a joint's measured rotation from the commanded rotation over about two seconds (rad), in
    /// addition to a fifth of that rotation.
    pub joint_deviation: f64,
    /// Maximum time by which the drives follow a command late (s): lag and dead time together.
    pub servo_lag: f64,
    /// Maximum apparent speed of a joint between two readings, as a multiple of its speed limit.
    pub joint_jump: f64,
    /// Number of consecutive new images with bit-identical forces after which the hand is stopped.
    pub frozen_frames: u32,
    /// Maximum difference between the effort of a joint's motor and the effort that balances the measured forces, as a
    /// fraction of the larger one, in addition to one and a half times the uncertainty of the effort. Has no effect
    /// without [efforts](crate::hand::JointEfforts).
    #[serde(skip_serializing_if = "is_usual_share")]
    pub effort_share: f64,
}

/// Default of `effort_share`.
const EFFORT_SHARE: f64 = 0.3;

/// Returns `true` if the share is the default, which is omitted so that files written before this key existed remain
/// unchanged.
fn is_usual_share(share: &f64) -> bool {
    *share == EFFORT_SHARE
}

impl Default for MonitorConfig {
    /// Values for drives with an encoder at each joint and cameras with noise.
    ///
    /// `joint_deviation`: 1.5 mm at a fingertip 0.1 m from the joint, a distance by which a columnar feeler yields;
    /// more than the encoder resolution, backlash and stick-slip of small drives. `servo_lag`: velocity loops of small
    /// drives have 3 to 50 ms, and a bus or a network adds a few periods. `joint_jump`: 2, to allow for overshoot.
    /// `frozen_frames`: 0.1 s at 100 Hz; camera noise makes even two identical images unlikely. `effort_share`: below
    /// 0.5, the difference if a sensor has twice the correct gain, and above the error of a calibrated skin.
    fn default() -> Self {
        Self {
            joint_deviation: 0.015,
            servo_lag: 0.08,
            joint_jump: 2.0,
            frozen_frames: 10,
            effort_share: EFFORT_SHARE,
        }
    }
}

impl MonitorConfig {
    /// Relative tolerance of a joint's measured motion, for the scale error of a velocity loop.
    pub const SCALE_TOLERANCE: f64 = 0.2;

    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let ranges = [
            ("joint_deviation", self.joint_deviation, 10.0),
            ("servo_lag", self.servo_lag, 2.0),
            ("joint_jump", self.joint_jump, 1e6),
            ("effort_share", self.effort_share, 10.0),
        ];
        for (field, value, most) in ranges {
            checker.between(&format!("{key}.{field}"), value, 0.0, most);
        }
    }

    /// Returns whether all values are the defaults, in which case the table is omitted.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
