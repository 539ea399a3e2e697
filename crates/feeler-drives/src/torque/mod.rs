//! Torque of a joint, estimated from the current of its motor.

mod identify;

pub use identify::{IdentifyError, TorqueSample, identify_torque};

use crate::config::TorqueCalibration;

/// Estimated torque that the motor exerts on the joint and its load, N m (N for a prismatic joint).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueEstimate {
    /// Torque, positive if it increases the joint's position.
    pub torque: f64,
    /// Standard error of the calibration; if the joint stands still, including the friction, whose direction is then
    /// unknown.
    pub uncertainty: f64,
}

impl TorqueEstimate {
    /// Estimates the torque at `current` (A) of a joint that moves in `direction`: 1, -1, or 0 if it stands still.
    pub fn of(calibration: &TorqueCalibration, current: f64, direction: f64) -> Self {
        let constant_error = calibration.constant_error * current;
        let friction_error = match direction {
            0.0 => calibration.friction,
            _ => calibration.friction_error,
        };
        Self {
            torque: calibration.constant * current - calibration.friction * direction,
            uncertainty: constant_error.hypot(friction_error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_acts_against_the_motion() {
        let calibration = TorqueCalibration {
            constant: 0.5,
            constant_error: 0.0,
            friction: 0.02,
            friction_error: 0.001,
        };
        let at = |direction| TorqueEstimate::of(&calibration, 0.2, direction);
        assert!((at(1.0).torque - 0.08).abs() < 1e-12);
        assert!((at(-1.0).torque - 0.12).abs() < 1e-12);
        assert!((at(0.0).torque - 0.1).abs() < 1e-12);
        assert_eq!([at(1.0).uncertainty, at(0.0).uncertainty], [0.001, 0.02]);
    }
}
