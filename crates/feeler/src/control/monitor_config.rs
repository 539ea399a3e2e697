//! By how much joints and pictures may differ from what a sound rig shows.

use crate::check::Checker;
use serde::{Deserialize, Serialize};

/// What the controller watches for sensors that lie. 0 switches a check off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MonitorConfig {
    /// Angle by which a joint's measured turn may differ from the commanded one within about two seconds, rad, beside
    /// a fifth of that turn.
    pub joint_deviation: f64,
    /// Time within which the drives do what they are told, s: lag and dead time together.
    pub servo_lag: f64,
    /// How many times its greatest joint speed a joint may seem to turn between two readings.
    pub joint_jump: f64,
    /// So many new pictures in a row that give a finger the same forces to the bit as the one before stop the hand.
    pub frozen_frames: u32,
}

impl Default for MonitorConfig {
    /// For drives with an encoder at each joint and cameras with noise.
    ///
    /// `joint_deviation`: 1.5 mm at a fingertip 0.1 m from the joint, which a columnar feeler gives way by; more than
    /// encoder steps, play and stick-slip of small drives amount to. `servo_lag`: velocity loops of small drives have
    /// 3 to 50 ms, and a bus or a network adds a few periods. `joint_jump`: twice, for overshoot. `frozen_frames`: 0.1 s at
    /// 100 Hz; the noise of any real camera makes even two equal pictures unlikely.
    fn default() -> Self {
        Self {
            joint_deviation: 0.015,
            servo_lag: 0.08,
            joint_jump: 2.0,
            frozen_frames: 10,
        }
    }
}

impl MonitorConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let ranges = [
            ("joint_deviation", self.joint_deviation, 10.0),
            ("servo_lag", self.servo_lag, 2.0),
            ("joint_jump", self.joint_jump, 1e6),
        ];
        for (field, value, most) in ranges {
            checker.between(&format!("{key}.{field}"), value, 0.0, most);
        }
    }

    /// Whether it is the default, which need not be written down.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
