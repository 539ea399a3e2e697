//! The servo of one joint: units, limits and last command.

use crate::config::JointDriveConfig;
use crate::error::{DriveError, JointName};
use crate::registers::{Model, Registers};
use feeler::hand::FingerGeometry;

/// A joint's servo.
#[derive(Debug, Clone)]
pub(crate) struct Servo {
    pub name: JointName,
    drive: JointDriveConfig,
    model: &'static Model,
    /// Limits of the joint's position (rad or m) and of its speed (rad/s or m/s).
    lower: f64,
    upper: f64,
    speed: f64,
    /// Displacement to which a tolerance of one radian applies: 1 rad, or the reach (m) for a prismatic joint.
    scale: f64,
    /// Last position, counts, unwrapped over turns.
    counts: Option<i64>,
    /// Last position (rad or m) and velocity (rad/s or m/s) of the joint.
    pub angle: f64,
    pub velocity: f64,
    /// Goal velocity, in the model's unit.
    pub goal: i64,
    /// Accumulated rounding error of the goals, in the model's unit.
    left_out: f64,
}

impl Servo {
    /// Creates the servo `name`, which moves a joint of the finger `geometry`.
    pub fn new(
        name: JointName,
        drive: &JointDriveConfig,
        model: &'static Model,
        geometry: &FingerGeometry,
    ) -> Self {
        Self {
            name,
            drive: drive.clone(),
            model,
            lower: geometry.joint_lower()[name.joint],
            upper: geometry.joint_upper()[name.joint],
            speed: geometry.joint_speed_limit()[name.joint],
            scale: geometry.joint_scale()[name.joint],
            counts: None,
            angle: 0.0,
            velocity: 0.0,
            goal: 0,
            left_out: 0.0,
        }
    }

    /// Maximum speed of a jogged joint, rad/s or m/s.
    pub fn jog_speed(&self) -> f64 {
        self.drive.jog_speed()
    }

    /// Unit of the joint's position.
    pub fn unit(&self) -> &'static str {
        self.drive.unit()
    }

    /// Checks that a velocity limit, in the servo's unit, is sufficient for the joint.
    pub fn allow(&self, limit: i64) -> Result<(), DriveError> {
        let expected = self.speed * self.drive.transmission();
        let actual = limit as f64 * self.model.velocity_unit;
        match actual >= expected {
            true => Ok(()),
            false => Err(DriveError::VelocityLimit {
                joint: self.name,
                expected,
                actual,
            }),
        }
    }

    /// Discards the last command and position.
    pub fn reset(&mut self) {
        self.goal = 0;
        self.left_out = 0.0;
        self.counts = None;
    }

    /// Updates position and velocity from `bytes`. If `wraps` is given, the position wraps after that number of counts.
    pub fn read(&mut self, registers: &Registers, bytes: &[u8], wraps: Option<i64>) {
        let read = registers.position.in_part(registers.motion.0, bytes);
        let counts = match (wraps, self.counts) {
            (None, _) => read,
            (Some(turn), before) => {
                // Choose the equivalent position nearest to the previous one, or initially to the middle of the range.
                let middle = (self.lower + self.upper) / 2.0;
                let near = before.unwrap_or_else(|| self.drive.counts(middle).round() as i64);
                near + (read - near + turn / 2).rem_euclid(turn) - turn / 2
            }
        };
        self.counts = Some(counts);
        self.angle = self.drive.angle(counts as f64);
        let units = registers.velocity.in_part(registers.motion.0, bytes) as f64;
        self.velocity = self.drive.joint_velocity(units * self.model.velocity_unit);
    }

    /// Checks that the joint is within its limits plus `tolerance` (rad, or times the reach) and not faster than `faster` times its limit.
    pub fn check(&self, tolerance: f64, faster: f64) -> Result<(), DriveError> {
        let tolerance = tolerance * self.scale;
        let (lower, upper) = (self.lower - tolerance, self.upper + tolerance);
        if !(lower..=upper).contains(&self.angle) {
            return Err(DriveError::BeyondLimits {
                joint: self.name,
                angle: self.angle,
                lower: self.lower,
                upper: self.upper,
                unit: self.unit(),
            });
        }
        let limit = faster * self.speed;
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

    /// Sets the goal for the joint's `velocity`, rad/s or m/s. Since a servo's unit of velocity is coarse, the rounding error
    /// of one goal is added to the next, so that the mean is exact. The goal for zero velocity is 0.
    pub fn command(&mut self, velocity: f64) -> Result<(), DriveError> {
        if velocity.is_nan() || velocity.abs() > self.speed * (1.0 + 1e-9) {
            return Err(DriveError::Command {
                joint: self.name,
                velocity,
                limit: self.speed,
                unit: self.unit(),
            });
        }
        if velocity == 0.0 {
            (self.goal, self.left_out) = (0, 0.0);
            return Ok(());
        }
        let wanted = self.drive.servo_velocity(velocity) / self.model.velocity_unit + self.left_out;
        self.goal = wanted.round() as i64;
        self.left_out = wanted - wanted.round();
        Ok(())
    }
}
