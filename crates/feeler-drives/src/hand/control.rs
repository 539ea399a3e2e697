//! Commands to the servos of a hand.

use super::DriveHand;
use crate::bus::BusError;
use crate::error::{DriveError, JointName};
use crate::registers::{GoalKind, Registers};
use crate::servo::{Servo, ServoJoint};
use feeler::hand::{
    Hand, HandCommand, HandError, HandState, JointEfforts, JointState, JointVector,
    check_finger_count,
};

impl DriveHand {
    /// Moves one joint, and all others that its servo moves, at `velocity` (rad/s or m/s of the joint) until the next
    /// command; the rest stands still. No joint may exceed its
    /// [`jog_speed`](crate::config::JointDriveConfig::jog_speed). Also checks the health of the servo if due. Intended for
    /// setting up a rig; use [`Hand::command`] to control a hand.
    ///
    /// # Errors
    /// If a fault has stopped the hand, if there is no such joint, or if `velocity` is too high. Also if
    /// [`Hand::command`] would fail; all motors are then stopped.
    pub fn jog(&mut self, finger: usize, joint: usize, velocity: f64) -> Result<(), DriveError> {
        if let Some(fault) = self.fault.clone() {
            return Err(DriveError::Stopped { fault });
        }
        let (index, moved) = self.find(finger, joint)?;
        let limit = self.servos[index].joints.jog_speed(&moved.drive);
        moved.check_command(velocity, limit)?;
        let (moved, servo_velocity) = (moved.name, moved.drive.servo_velocity(velocity));
        let sent = self.send(|other| match other.name {
            name if name == moved => velocity,
            name if name.id == moved.id => other.drive.joint_velocity(servo_velocity),
            _ => 0.0,
        });
        let done = sent.and_then(|()| self.check_health_if_due(index));
        if let Err(error) = &done {
            self.fail(error);
        }
        done
    }

    /// Returns the joint with these indices, and the index of its servo.
    fn find(&self, finger: usize, joint: usize) -> Result<(usize, &ServoJoint), DriveError> {
        let servos = self.servos.iter().enumerate();
        let mut joints = servos.flat_map(|(index, servo)| {
            let joints = servo.joints.iter();
            joints.map(move |joint| (index, joint))
        });
        let found = joints.find(|(_, own)| (own.name.finger, own.name.joint) == (finger, joint));
        found.ok_or_else(|| DriveError::no_joint(finger, joint, &self.fingers))
    }

    /// Commands each joint to move at its `velocity`, rad/s or m/s, unless the joint angles are too old.
    fn send(&mut self, velocity: impl Fn(&ServoJoint) -> f64) -> Result<(), DriveError> {
        let moving = self.joints().any(|joint| velocity(joint) != 0.0);
        let age = self.age();
        if moving && age > self.most_age {
            let limit = self.most_age;
            return Err(DriveError::Stale { age, limit });
        }
        // Time comes from the data: goals do not advance without new joint angles.
        let elapsed = (self.stamp - self.commanded).clamp(0.0, self.most_age);
        self.commanded = self.stamp;
        for servo in &mut self.servos {
            servo.command(&velocity, elapsed)?;
        }
        Ok(self.write_goals()?)
    }

    /// Writes the goals of all servos, one packet per kind of goal.
    pub(super) fn write_goals(&mut self) -> Result<(), BusError> {
        let registers = Registers::of(self.config.protocol);
        for kind in GoalKind::ALL {
            let servos = self.servos.iter();
            let servos = servos.filter(|servo| servo.kind() == kind && servo.has_goal());
            let mut goals = servos.map(|servo| (servo.name().id, servo.goal)).peekable();
            if goals.peek().is_some() {
                self.bus.sync_write(registers.goal(kind), goals)?;
            }
        }
        Ok(())
    }

    /// Estimates the effort of each motor on its first joint from its latest current. The efforts of a finger without
    /// calibrations are empty.
    fn estimate_efforts(&self, efforts: &mut [JointEfforts]) {
        efforts.fill(JointEfforts::default());
        for servo in &self.servos {
            let JointName { finger, joint, .. } = servo.name();
            let (Some(estimate), Some(own)) = (servo.effort(), efforts.get_mut(finger)) else {
                continue;
            };
            let joints = self.config.finger[finger].joint.len();
            if own.effort.is_empty() {
                own.effort = JointVector::splat(joints, f64::NAN);
                own.uncertainty = JointVector::zeros(joints);
            }
            own.effort[joint] = estimate.torque;
            own.uncertainty[joint] = estimate.uncertainty;
        }
    }

    /// Commands all joints, then checks the health of the next servo if due.
    fn drive(&mut self, velocity: &[JointVector]) -> Result<(), DriveError> {
        let at = |joint: &ServoJoint| {
            let own = velocity.get(joint.name.finger);
            own.map_or(0.0, |own| own[joint.name.joint])
        };
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
        for joint in self.joints() {
            let joints = &mut state.joints[joint.name.finger];
            joints.position[joint.name.joint] = joint.angle;
            joints.velocity[joint.name.joint] = joint.velocity;
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
