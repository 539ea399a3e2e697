//! A joint that a servo moves: its units, limits and latest motion.

use crate::config::JointDriveConfig;
use crate::error::{DriveError, JointName};
use feeler::hand::FingerGeometry;
use std::f64::consts::PI;

/// Limits of a joint's position (rad or m) and of its speed (rad/s or m/s).
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointLimits {
    pub lower: f64,
    pub upper: f64,
    pub speed: f64,
}

/// A joint that a servo moves.
#[derive(Debug, Clone)]
pub(crate) struct ServoJoint {
    pub name: JointName,
    pub drive: JointDriveConfig,
    pub limits: JointLimits,
    /// Factor from a tolerance in radians to the joint's position: 1 for a revolute joint, the reach (m) for a
    /// prismatic joint.
    scale: f64,
    /// Last position (rad or m).
    pub angle: f64,
    /// Last velocity (rad/s or m/s).
    pub velocity: f64,
}

impl ServoJoint {
    /// Creates the joint `name` of the finger `geometry`, at position 0.
    pub fn new(name: JointName, drive: &JointDriveConfig, geometry: &FingerGeometry) -> Self {
        Self {
            name,
            drive: drive.clone(),
            limits: JointLimits {
                lower: geometry.joint_lower()[name.joint],
                upper: geometry.joint_upper()[name.joint],
                speed: geometry.joint_speed_limit()[name.joint],
            },
            scale: geometry.joint_scale()[name.joint],
            angle: 0.0,
            velocity: 0.0,
        }
    }

    /// Unit of the joint's position.
    pub fn unit(&self) -> &'static str {
        self.drive.unit()
    }

    /// Returns the limits of `other`, which the same servo moves, converted to this joint.
    pub fn converted_limits(&self, other: &Self) -> JointLimits {
        let own = |position: f64| self.drive.position(other.drive.horn(position));
        let (lower, upper) = (own(other.limits.lower), own(other.limits.upper));
        JointLimits {
            lower: lower.min(upper),
            upper: lower.max(upper),
            speed: (self.drive.ratio_to(&other.drive) * other.limits.speed).abs(),
        }
    }

    /// Updates position and velocity from the angle (rad) and velocity (rad/s) of the servo's horn.
    pub fn update(&mut self, horn: f64, velocity: f64) {
        self.angle = self.drive.position(horn);
        self.velocity = self.drive.joint_velocity(velocity);
    }

    /// Checks that the joint is beyond its limits by at most `tolerance` (rad; for a prismatic joint, times the reach,
    /// in m), and that its speed is at most `faster` times the speed limit.
    pub fn check(&self, tolerance: f64, faster: f64) -> Result<(), DriveError> {
        let JointLimits {
            lower,
            upper,
            speed,
        } = self.limits;
        let tolerance = tolerance * self.scale;
        if !(lower - tolerance..=upper + tolerance).contains(&self.angle) {
            return Err(DriveError::BeyondLimits {
                joint: self.name,
                angle: self.angle,
                lower,
                upper,
                unit: self.unit(),
            });
        }
        let limit = faster * speed;
        if self.velocity.abs() > limit {
            return Err(DriveError::TooFast {
                joint: self.name,
                velocity: self.velocity,
                limit,
                unit: self.unit(),
            });
        }
        Ok(())
    }

    /// Checks that the position has not changed by half a turn of the servo or more since the joint was at `before`
    /// (rad or m), which happens if the servo restarts in another turn.
    pub fn check_turn(&self, before: f64) -> Result<(), DriveError> {
        let turned = self.drive.horn(self.angle) - self.drive.horn(before);
        match turned.abs() < PI {
            true => Ok(()),
            false => Err(DriveError::TurnLost {
                joint: self.name,
                before,
                angle: self.angle,
                unit: self.unit(),
            }),
        }
    }

    /// Checks that a commanded `velocity` (rad/s or m/s) is a number and at most `limit`.
    pub fn check_command(&self, velocity: f64, limit: f64) -> Result<(), DriveError> {
        if velocity.is_nan() || velocity.abs() > limit * (1.0 + 1e-9) {
            return Err(DriveError::Command {
                joint: self.name,
                velocity,
                limit,
                unit: self.unit(),
            });
        }
        Ok(())
    }
}
