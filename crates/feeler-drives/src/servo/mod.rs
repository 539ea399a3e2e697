//! The servo of one joint: units, limits and last command.

mod follower;

use crate::config::JointDriveConfig;
use crate::error::{DriveError, JointName};
use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, GoalKind, Model, Registers};
use crate::torque::TorqueEstimate;
use feeler::hand::FingerGeometry;
use follower::Follower;

/// Limits of a joint's position (rad or m) and of its speed (rad/s or m/s).
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointLimits {
    pub lower: f64,
    pub upper: f64,
    pub speed: f64,
}

impl JointLimits {
    /// Limits of the joint `name` of the finger `geometry`.
    pub fn of(name: JointName, geometry: &FingerGeometry) -> Self {
        Self {
            lower: geometry.joint_lower()[name.joint],
            upper: geometry.joint_upper()[name.joint],
            speed: geometry.joint_speed_limit()[name.joint],
        }
    }
}

/// A joint's servo.
#[derive(Debug, Clone)]
pub(crate) struct Servo {
    pub name: JointName,
    pub drive: JointDriveConfig,
    pub model: &'static Model,
    limits: JointLimits,
    /// Factor from a tolerance in radians to the joint's position: 1 for a revolute joint, the reach (m) for a
    /// prismatic joint.
    scale: f64,
    /// Last position, counts, unwrapped over turns.
    counts: Option<i64>,
    /// Last position of the joint (rad or m).
    pub angle: f64,
    /// Last velocity of the joint (rad/s or m/s).
    pub velocity: f64,
    /// Last current, A, positive if it increases the joint's position. 0 if it is not read.
    pub current: f64,
    follower: Follower,
    /// Value of the goal register.
    pub goal: i64,
    /// `true` once the goal was set to the measured position.
    held: bool,
}

impl Servo {
    /// Creates the servo `name`, which moves a joint of the finger `geometry`. Its commands are based on measurements
    /// that are at most `most_age` old, s.
    pub fn new(
        name: JointName,
        drive: &JointDriveConfig,
        model: &'static Model,
        geometry: &FingerGeometry,
        most_age: f64,
    ) -> Self {
        let limits = JointLimits::of(name, geometry);
        let leash = limits.speed * most_age;
        let range = (limits.lower, limits.upper);
        Self {
            name,
            drive: drive.clone(),
            model,
            limits,
            scale: geometry.joint_scale()[name.joint],
            counts: None,
            angle: 0.0,
            velocity: 0.0,
            current: 0.0,
            follower: Follower::new(drive, range, limits.speed, leash),
            goal: 0,
            held: false,
        }
    }

    /// Returns `true` if the goal may be written: a goal position only after the joint was measured.
    pub fn has_goal(&self) -> bool {
        self.held || self.kind() == GoalKind::Velocity
    }

    /// Kind of the goal.
    pub fn kind(&self) -> GoalKind {
        self.drive.mode.goal()
    }

    /// Unit of the joint's position.
    pub fn unit(&self) -> &'static str {
        self.drive.unit()
    }

    /// Velocity of the servo at the joint's speed limit, in the model's unit.
    pub fn profile_velocity(&self) -> i64 {
        let velocity = self.limits.speed * self.drive.transmission();
        (velocity / self.model.velocity_unit).ceil() as i64
    }

    /// Checks that a velocity limit, in the servo's unit, allows the joint's speed limit.
    pub fn allow(&self, limit: i64) -> Result<(), DriveError> {
        let expected = self.limits.speed * self.drive.transmission();
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
        self.counts = None;
        self.held = false;
        self.stop();
    }

    /// Updates position, velocity and current from the `bytes` of a part of the control table that begins at the address
    /// `begin`.
    pub fn read(&mut self, begin: u16, bytes: &[u8]) {
        let registers = Registers::of(self.model.protocol);
        let read = registers.position.in_part(begin, bytes);
        let counts = match self.model.protocol {
            Protocol::Dynamixel => read,
            // Positions wrap after a turn. Choose the equivalent position nearest to the previous one, or initially to the
            // middle of the range.
            Protocol::Feetech => {
                let turn = COUNTS_PER_TURN as i64;
                let middle = (self.limits.lower + self.limits.upper) / 2.0;
                let near =
                    (self.counts).unwrap_or_else(|| self.drive.counts(middle).round() as i64);
                near + (read - near + turn / 2).rem_euclid(turn) - turn / 2
            }
        };
        self.counts = Some(counts);
        self.angle = self.drive.angle(counts as f64);
        let units = registers.velocity.in_part(begin, bytes) as f64;
        self.velocity = self.drive.joint_velocity(units * self.model.velocity_unit);
        let units = registers.current.in_part(begin, bytes) as f64;
        self.current = f64::from(self.drive.direction) * units * self.model.current_unit;
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
        let turned = self.drive.counts(self.angle) - self.drive.counts(before);
        match turned.abs() < COUNTS_PER_TURN / 2.0 {
            true => Ok(()),
            false => Err(DriveError::TurnLost {
                joint: self.name,
                before,
                angle: self.angle,
                unit: self.unit(),
            }),
        }
    }

    /// Sets the goal for the joint's `velocity`, rad/s or m/s. The latest measurement is `elapsed` seconds after that of
    /// the previous command.
    pub fn command(&mut self, velocity: f64, elapsed: f64) -> Result<(), DriveError> {
        if velocity.is_nan() || velocity.abs() > self.limits.speed * (1.0 + 1e-9) {
            return Err(DriveError::Command {
                joint: self.name,
                velocity,
                limit: self.limits.speed,
                unit: self.unit(),
            });
        }
        let follower = &mut self.follower;
        self.goal = follower.follow(velocity, self.angle, elapsed, &self.drive, self.model);
        Ok(())
    }

    /// Sets the goal that holds the joint at its latest measured position.
    pub fn hold(&mut self) {
        self.follower.hold(self.angle);
        self.held = true;
        self.stop();
    }

    /// Sets the goal that stops the joint.
    pub fn stop(&mut self) {
        self.goal = self.follower.stop(&self.drive, self.model);
    }

    /// Effort of the motor on the joint, or `None` without a calibration. The friction is part of the uncertainty even if
    /// the joint moves: in a position mode it moves in small steps, between which friction acts in either direction.
    pub fn effort(&self) -> Option<TorqueEstimate> {
        let calibration = self.drive.torque?;
        Some(TorqueEstimate::of(&calibration, self.current, 0.0))
    }

    /// Torque that the motor exerts on the joint, or `None` without a calibration.
    pub fn torque(&self) -> Option<TorqueEstimate> {
        let calibration = self.drive.torque?;
        // Slower than one unit of its velocity, the servo does not measure the direction.
        let unit = self.drive.joint_velocity(self.model.velocity_unit).abs();
        let direction = match self.velocity {
            velocity if velocity.abs() < 1.5 * unit => 0.0,
            velocity => velocity.signum(),
        };
        Some(TorqueEstimate::of(&calibration, self.current, direction))
    }
}
