//! A servo: units, limits and last command.

mod follower;
mod joint;
mod joints;

pub(crate) use joint::ServoJoint;
pub(crate) use joints::ServoJoints;

use crate::config::JointDriveConfig;
use crate::error::{DriveError, JointName};
use crate::health::OVERLOAD;
use crate::registers::{GoalKind, Model, Register, Registers};
use crate::torque::TorqueEstimate;
use follower::Follower;

/// A servo and the joints that it moves.
#[derive(Debug, Clone)]
pub(crate) struct Servo {
    pub joints: ServoJoints,
    pub model: &'static Model,
    /// Last position, counts, unwrapped over turns.
    counts: Option<i64>,
    /// Last current, A, positive if it increases the position of the first joint. 0 if it is not read.
    pub current: f64,
    follower: Follower,
    /// Value of the goal register.
    pub goal: i64,
    /// `true` once the goal was set to the measured position.
    held: bool,
    /// `true` if the servo has reported an overload since the last [`reset`](Self::reset).
    overloaded: bool,
}

impl Servo {
    /// Creates the servo of these `joints`. Its commands are based on measurements that are at most `most_age` old, s.
    pub fn new(joints: ServoJoints, model: &'static Model, most_age: f64) -> Self {
        let (drive, limits) = (&joints.first.drive, joints.limits);
        let leash = limits.speed * most_age;
        let range = (limits.lower, limits.upper);
        Self {
            model,
            counts: None,
            current: 0.0,
            follower: Follower::new(drive, range, limits.speed, leash),
            goal: 0,
            held: false,
            overloaded: false,
            joints,
        }
    }

    /// Name of the servo by its first joint.
    pub fn name(&self) -> JointName {
        self.joints.first.name
    }

    /// Settings of the servo.
    pub fn drive(&self) -> &JointDriveConfig {
        &self.joints.first.drive
    }

    /// Returns `true` if the goal may be written: a goal position only after the joint was measured, and not after an
    /// overload, which a new goal position would end on Feetech servos, while the motor still pushes.
    pub fn has_goal(&self) -> bool {
        (self.held && !self.overloaded) || self.kind() == GoalKind::Velocity
    }

    /// Kind of the goal.
    pub fn kind(&self) -> GoalKind {
        self.drive().mode().goal()
    }

    /// Velocity of the servo at the speed limit of its joints, in the model's unit.
    pub fn profile_velocity(&self) -> i64 {
        let velocity = self.joints.limits.speed * self.drive().transmission();
        (velocity / self.model.velocity_unit).ceil() as i64
    }

    /// Discards the last command and position.
    pub fn reset(&mut self) {
        self.counts = None;
        self.held = false;
        self.overloaded = false;
        self.stop();
    }

    /// Registers the `faults` that the servo reports.
    pub fn notice(&mut self, faults: u8) {
        self.overloaded |= faults & OVERLOAD != 0;
    }

    /// Allows a new goal, which ends an overload. Call this only without torque.
    pub fn end_overload(&mut self) {
        self.overloaded = false;
    }

    /// Updates position, velocity and current from the `bytes` of a part of the control table that begins at the address
    /// `begin`.
    pub fn read(&mut self, begin: u16, bytes: &[u8]) {
        let registers = Registers::of(self.model.protocol);
        let reported = registers.position.in_part(begin, bytes);
        let counts = self
            .joints
            .unwrap_position(self.model, reported, self.counts);
        self.counts = Some(counts);
        let units = registers.velocity.in_part(begin, bytes) as f64;
        let horn = self.model.to_angle(counts as f64);
        self.joints.update(horn, units * self.model.velocity_unit);
        let current = |register: Register| register.in_part(begin, bytes) as f64;
        let units = registers.current.map_or(0.0, current);
        self.current = f64::from(self.drive().direction) * units * self.model.current_unit;
    }

    /// Sets the goal for the `velocity` of each joint, rad/s or m/s: the servo follows the slowest one. The latest
    /// measurement is `elapsed` seconds after that of the previous command.
    pub fn command(
        &mut self,
        velocity: impl Fn(&ServoJoint) -> f64,
        elapsed: f64,
    ) -> Result<(), DriveError> {
        let velocity = self.joints.common_velocity(velocity)?;
        let ServoJoint { drive, angle, .. } = &self.joints.first;
        let follower = &mut self.follower;
        self.goal = follower.follow(velocity, *angle, elapsed, drive, self.model);
        Ok(())
    }

    /// Sets the goal that holds the joints at their latest measured position.
    pub fn hold(&mut self) {
        self.follower.hold(self.joints.first.angle);
        self.held = true;
        self.stop();
    }

    /// Sets the goal that stops the joints.
    pub fn stop(&mut self) {
        self.goal = self.follower.stop(&self.joints.first.drive, self.model);
    }

    /// Effort of the motor on its first joint, or `None` without a calibration. The friction is part of the uncertainty even if
    /// the joint moves: in a position mode it moves in small steps, between which friction acts in either direction.
    pub fn effort(&self) -> Option<TorqueEstimate> {
        let calibration = self.drive().torque?;
        Some(TorqueEstimate::of(&calibration, self.current, 0.0))
    }

    /// Torque that the motor exerts on its first joint, or `None` without a calibration.
    pub fn torque(&self) -> Option<TorqueEstimate> {
        let calibration = self.drive().torque?;
        // Slower than one unit of its velocity, the servo does not measure the direction.
        let unit = self.drive().joint_velocity(self.model.velocity_unit).abs();
        let direction = match self.joints.first.velocity {
            velocity if velocity.abs() < 1.5 * unit => 0.0,
            velocity => velocity.signum(),
        };
        Some(TorqueEstimate::of(&calibration, self.current, direction))
    }
}
