//! The servos of a bus as feeler's hand.

mod arm;
mod readings;

use crate::bus::{Bus, BusError};
use crate::clock::RigClock;
use crate::config::DrivesConfig;
use crate::error::{DriveError, JointName};
use crate::registers::Registers;
use crate::servo::Servo;
use crate::setup::blame;
use feeler::check::Checker;
use feeler::hand::finger::FingerGeometry;
use feeler::hand::{Hand, HandCommand, HandError, HandState, check_finger_count};
use glam::DVec3;

/// Greatest speed of a jogged joint, rad/s.
pub const JOG_SPEED: f64 = 0.2;

/// A hand whose joints are moved by servos in velocity mode. While there is one, the motors have power; what is wrong with one
/// servo, or the bus, stops all, and they stay stopped until [`restart`](Self::restart).
pub struct DriveHand {
    bus: Bus,
    config: DrivesConfig,
    clock: RigClock,
    /// Oldest joint angles that a command may be made of, s.
    most_age: f64,
    fingers: usize,
    servos: Vec<Servo>,
    ids: Vec<u8>,
    /// When the newest joint angles arrived, s of the clock.
    stamp: f64,
    /// When a servo was last asked for its health, s of the clock.
    asked: f64,
    /// The servo that is asked next, in turn.
    next_asked: usize,
    fault: Option<String>,
}

impl DriveHand {
    /// Opens the bus of `config`, whose servos move `fingers`, sets them and gives their motors power. They stand still until they are
    /// commanded, and no command may be made of joint angles that are older than `most_age`, s. States are stamped by `clock`.
    ///
    /// # Errors
    /// When a value of `config` is out of its range, the port cannot be opened, or a servo is missing, another than it should be, not
    /// well, or beyond its joint's limits.
    pub fn open(
        config: &DrivesConfig,
        fingers: &[FingerGeometry],
        most_age: f64,
        clock: RigClock,
    ) -> Result<Self, DriveError> {
        check(config, fingers)?;
        let how = (config.protocol, config.baud_rate);
        let bus = Bus::open(&config.port, how, config.reply_timeout, clock)?;
        Self::on(bus, config, fingers, most_age)
    }

    /// The same on a `bus` that is open already, whatever port `config` names. States are stamped by the clock of the bus.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn on(
        bus: Bus,
        config: &DrivesConfig,
        fingers: &[FingerGeometry],
        most_age: f64,
    ) -> Result<Self, DriveError> {
        check(config, fingers)?;
        let mut hand = Self {
            clock: bus.clock().clone(),
            bus,
            most_age,
            fingers: fingers.len(),
            servos: Vec::new(),
            ids: config.joints().map(|joint| joint.id).collect(),
            stamp: 0.0,
            asked: 0.0,
            next_asked: 0,
            fault: None,
            config: config.clone(),
        };
        hand.set_up(fingers)?;
        hand.arm()?;
        Ok(hand)
    }

    /// Lets a hand that was stopped by a fault move again: sets the watchdogs and gives the motors power, after somebody has looked why
    /// it stopped.
    ///
    /// # Errors
    /// When a servo is not well; then it stays stopped.
    pub fn restart(&mut self) -> Result<(), DriveError> {
        self.power_off();
        self.arm()?;
        self.fault = None;
        Ok(())
    }

    /// Why it is stopped for good, if it is.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Age of the newest joint angles, s.
    pub fn age(&self) -> f64 {
        self.clock.now() - self.stamp
    }

    /// The joint angles of each finger as of the newest reading, rad.
    pub fn angles(&self) -> impl Iterator<Item = (JointName, f64)> {
        self.servos.iter().map(|servo| (servo.name, servo.angle))
    }

    /// Turns one joint at `velocity`, rad/s, at most [`JOG_SPEED`], until the next command; all others stand still. Its servo is asked
    /// whether it is well, where that is due. For whoever sets a rig up; a program that controls a hand has [`Hand::command`].
    ///
    /// # Errors
    /// When a fault has stopped it, there is no such joint or `velocity` is too fast; or as [`Hand::command`], and then all motors are
    /// stopped.
    pub fn jog(&mut self, finger: usize, joint: usize, velocity: f64) -> Result<(), DriveError> {
        if let Some(fault) = self.fault.clone() {
            return Err(DriveError::Stopped { fault });
        }
        let index = 3 * finger + joint;
        let Some(servo) = self.servos.get(index).filter(|_| joint < 3) else {
            let joint = joint + 1;
            return Err(DriveError::NoJoint { finger, joint });
        };
        if velocity.is_nan() || velocity.abs() > JOG_SPEED {
            return Err(DriveError::Command {
                joint: servo.name,
                velocity,
                limit: JOG_SPEED,
            });
        }
        let sent = self.send(|other| if other == index { velocity } else { 0.0 });
        let done = sent.and_then(|()| self.check_health_if_due(index));
        if let Err(error) = &done {
            self.fail(error);
        }
        done
    }

    /// Sends each joint its `velocity`, rad/s, by its number, unless the joint angles that it was made of are too old.
    fn send(&mut self, velocity: impl Fn(usize) -> f64) -> Result<(), DriveError> {
        let joints = 0..self.servos.len();
        let moving = joints.into_iter().any(|index| velocity(index) != 0.0);
        let age = self.age();
        if moving && age > self.most_age {
            let limit = self.most_age;
            return Err(DriveError::Stale { age, limit });
        }
        for (index, servo) in self.servos.iter_mut().enumerate() {
            servo.command(velocity(index))?;
        }
        let goals = self.servos.iter().map(|servo| (servo.name.id, servo.goal));
        let register = Registers::of(self.config.protocol).goal_velocity;
        Ok(self.bus.sync_write(register, goals)?)
    }

    /// Commands the joints; then asks the next servo whether it is well, where that is due.
    fn drive(&mut self, velocity: &[DVec3]) -> Result<(), DriveError> {
        let at = |index: usize| velocity.get(index / 3).map_or(0.0, |v| v[index % 3]);
        self.send(at)?;
        self.check_health_if_due(self.next_asked)
    }

    /// Stops all motors at once, as far as the bus still works, and keeps them stopped.
    fn fail(&mut self, error: &DriveError) -> HandError {
        self.stop_motors();
        let fault = self.fault.get_or_insert_with(|| error.to_string());
        HandError::Failed(fault.clone())
    }

    fn stop_motors(&mut self) {
        for servo in &mut self.servos {
            servo.reset();
        }
        let register = Registers::of(self.config.protocol).goal_velocity;
        let stop = self.ids.iter().map(|&id| (id, 0));
        // Where the bus fails, the servos' watchdogs stop them.
        let _ = self.bus.sync_write(register, stop);
    }

    fn power_off(&mut self) {
        self.stop_motors();
        let register = Registers::of(self.config.protocol).torque;
        // Twice, as nobody answers that it arrived.
        for _ in 0..2 {
            let off = self.ids.iter().map(|&id| (id, 0));
            let _ = self.bus.sync_write(register, off);
        }
    }

    /// An error of the bus, laid to the joint whose servo it names.
    fn blame_by_id(&self, source: BusError) -> DriveError {
        let id = source.servo();
        let servo = self.servos.iter().find(|servo| Some(servo.name.id) == id);
        match servo {
            Some(servo) => blame(servo.name)(source),
            None => source.into(),
        }
    }
}

/// Requires the values of `config` to be in their ranges, for a hand of these `fingers`.
fn check(config: &DrivesConfig, fingers: &[FingerGeometry]) -> Result<(), DriveError> {
    let mut checker = Checker::default();
    config.check("drives", fingers.len(), &mut checker);
    let problems = checker.problems();
    match problems.is_empty() {
        true => Ok(()),
        false => Err(DriveError::Config(problems)),
    }
}

impl Drop for DriveHand {
    fn drop(&mut self) {
        self.power_off();
    }
}

impl Hand for DriveHand {
    fn finger_count(&self) -> usize {
        self.fingers
    }

    /// The stamp is when the answers had arrived.
    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers, state.joints.len())?;
        if let Some(fault) = &self.fault {
            return Err(HandError::Failed(fault.clone()));
        }
        if let Err(error) = self.read_motion() {
            return Err(self.fail(&error));
        }
        state.stamp = self.stamp;
        for servo in &self.servos {
            let joints = &mut state.joints[servo.name.finger];
            joints.position[servo.name.joint] = servo.angle;
            joints.velocity[servo.name.joint] = servo.velocity;
        }
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers, command.joint_velocity().len())?;
        if let Some(fault) = &self.fault {
            let fault = fault.clone();
            self.stop_motors();
            return Err(HandError::Failed(fault));
        }
        match self.drive(command.joint_velocity()) {
            Ok(()) => Ok(()),
            Err(error) => Err(self.fail(&error)),
        }
    }
}
