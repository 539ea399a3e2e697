//! Commands to the servos of a hand.

use super::DriveHand;
use crate::bus::BusError;
use crate::error::{DriveError, JointName};
use crate::registers::{GoalKind, Registers};
use crate::servo::Servo;
use feeler::hand::{
    Hand, HandCommand, HandError, HandState, JointEfforts, JointState, JointVector,
    check_finger_count,
};

impl DriveHand {
    /// Moves one joint at `velocity` (rad/s or m/s), at most its
    /// [`jog_speed`](crate::config::JointDriveConfig::jog_speed), until the next command; all others stand still. Also
    /// checks the health of its servo if due. Intended for setting up a rig; use [`Hand::command`] to control a hand.
    ///
    /// # Errors
    /// If a fault has stopped the hand, if there is no such joint, or if `velocity` is too high. Also if
    /// [`Hand::command`] would fail; all motors are then stopped.
    pub fn jog(&mut self, finger: usize, joint: usize, velocity: f64) -> Result<(), DriveError> {
        if let Some(fault) = self.fault.clone() {
            return Err(DriveError::Stopped { fault });
        }
        let is_asked = |servo: &Servo| (servo.name.finger, servo.name.joint) == (finger, joint);
        let Some(index) = self.servos.iter().position(is_asked) else {
            return Err(DriveError::no_joint(finger, joint, &self.fingers));
        };
        let servo = &self.servos[index];
        let (moved, limit, unit) = (servo.name, servo.drive.jog_speed(), servo.unit());
        if velocity.is_nan() || velocity.abs() > limit {
            return Err(DriveError::Command {
                joint: moved,
                velocity,
                limit,
                unit,
            });
        }
        let sent = self.send(|other| if other == moved { velocity } else { 0.0 });
        let done = sent.and_then(|()| self.check_health_if_due(index));
        if let Err(error) = &done {
            self.fail(error);
        }
        done
    }

    /// Commands each joint to move at its `velocity`, rad/s or m/s, unless the joint angles are too old.
    fn send(&mut self, velocity: impl Fn(JointName) -> f64) -> Result<(), DriveError> {
        let moving = self.servos.iter().any(|servo| velocity(servo.name) != 0.0);
        let age = self.age();
        if moving && age > self.most_age {
            let limit = self.most_age;
            return Err(DriveError::Stale { age, limit });
        }
        // Time comes from the data: goals do not advance without new joint angles.
        let elapsed = (self.stamp - self.commanded).clamp(0.0, self.most_age);
        self.commanded = self.stamp;
        for servo in &mut self.servos {
            servo.command(velocity(servo.name), elapsed)?;
        }
        Ok(self.write_goals()?)
    }

    /// Writes the goals of all servos, one packet per kind of goal.
    fn write_goals(&mut self) -> Result<(), BusError> {
        let registers = Registers::of(self.config.protocol);
        for kind in GoalKind::ALL {
            let servos = self.servos.iter();
            let servos = servos.filter(|servo| servo.kind() == kind && servo.has_goal());
            let mut goals = servos.map(|servo| (servo.name.id, servo.goal)).peekable();
            if goals.peek().is_some() {
                self.bus.sync_write(registers.goal(kind), goals)?;
            }
        }
        Ok(())
    }

    /// Estimates the effort of each joint from the latest current of its motor. The efforts of a finger without
    /// calibrations are empty.
    fn estimate_efforts(&self, efforts: &mut [JointEfforts]) {
        efforts.fill(JointEfforts::default());
        for servo in &self.servos {
            let (Some(estimate), Some(own)) = (servo.effort(), efforts.get_mut(servo.name.finger))
            else {
                continue;
            };
            let joints = self.config.finger[servo.name.finger].joint.len();
            if own.effort.is_empty() {
                own.effort = JointVector::splat(joints, f64::NAN);
                own.uncertainty = JointVector::zeros(joints);
            }
            own.effort[servo.name.joint] = estimate.torque;
            own.uncertainty[servo.name.joint] = estimate.uncertainty;
        }
    }

    /// Commands all joints, then checks the health of the next servo if due.
    fn drive(&mut self, velocity: &[JointVector]) -> Result<(), DriveError> {
        let at = |name: JointName| velocity.get(name.finger).map_or(0.0, |v| v[name.joint]);
        self.send(at)?;
        self.check_health_if_due(self.next_asked)
    }

    /// Stops all motors if the bus still works, and rejects further commands.
    fn fail(&mut self, error: &DriveError) -> HandError {
        self.stop_motors();
        let fault = self.fault.get_or_insert_with(|| error.to_string());
        HandError::Failed(fault.clone())
    }

    pub(super) fn stop_motors(&mut self) {
        self.servos.iter_mut().for_each(Servo::stop);
        // If the bus fails, the servos' watchdogs stop the motors.
        let _ = self.write_goals();
    }
}

impl Hand for DriveHand {
    fn finger_count(&self) -> usize {
        self.fingers.len()
    }

    /// Reads the state, which is stamped with the time at which the responses had arrived.
    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers.len(), state.joints.len())?;
        if let Some(fault) = &self.fault {
            return Err(HandError::Failed(fault.clone()));
        }
        self.read_motion().map_err(|error| self.fail(&error))?;
        state.stamp = self.stamp;
        for (joints, drives) in state.joints.iter_mut().zip(&self.config.finger) {
            *joints = JointState::zero(drives.joint.len());
        }
        for servo in &self.servos {
            let joints = &mut state.joints[servo.name.finger];
            joints.position[servo.name.joint] = servo.angle;
            joints.velocity[servo.name.joint] = servo.velocity;
        }
        self.estimate_efforts(&mut state.efforts);
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers.len(), command.joint_velocity().len())?;
        if let Some(fault) = &self.fault {
            let fault = fault.clone();
            self.stop_motors();
            return Err(HandError::Failed(fault));
        }
        self.drive(command.joint_velocity())
            .map_err(|error| self.fail(&error))
    }
}
