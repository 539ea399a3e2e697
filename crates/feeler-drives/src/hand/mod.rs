//! Implementation of the trait `Hand` with servos on a bus.

mod arm;
mod control;
mod latency;
mod readings;

use crate::bus::{Bus, BusError};
use crate::clock::RigClock;
use crate::config::DrivesConfig;
use crate::error::{DriveError, JointName};
use crate::registers::Registers;
use crate::servo::{Servo, ServoJoint};
use crate::setup::{blame, set};
use crate::torque::TorqueEstimate;
use feeler::check::Checker;
use feeler::hand::FingerGeometry;

/// A hand whose joints are moved by servos, each in its [`DriveMode`](crate::registers::DriveMode). Torque is on while it
/// exists. A fault of one servo or of the bus stops all motors until [`restart`](Self::restart).
pub struct DriveHand {
    bus: Bus,
    config: DrivesConfig,
    clock: RigClock,
    /// Maximum age of the joint angles that a command is based on, s.
    most_age: f64,
    fingers: Vec<FingerGeometry>,
    servos: Vec<Servo>,
    ids: Vec<u8>,
    /// Part of the control table read in every period.
    motion: (u16, usize),
    /// Time at which the oldest of the latest joint angles arrived, s of the clock.
    stamp: f64,
    /// Stamp of the joint angles that the latest command was based on, s of the clock.
    commanded: f64,
    /// Time of the last health check, s of the clock.
    asked: f64,
    /// Index of the servo whose health is checked next.
    next_asked: usize,
    fault: Option<String>,
}

impl DriveHand {
    /// Opens the bus of `config`, configures the servos and switches their torque on. The motors stand still until they
    /// are commanded. A command is rejected if the latest joint angles are older than `most_age`, s. States are stamped
    /// by `clock`.
    ///
    /// # Errors
    /// If a value of `config` is out of range, if the port cannot be opened, or if a servo is missing, of another
    /// model, faulty, slower than its joints' speed limits, or beyond its joint's limits. The error is
    /// [`DriveError::TorqueMayBeOn`] if not every servo confirms afterwards that its torque is off.
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

    /// Like [`open`](Self::open), but on an existing `bus`, whose clock stamps the states. Ignores `config.port`.
    ///
    /// # Errors
    /// See [`open`](Self::open).
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
            fingers: fingers.to_vec(),
            servos: Vec::new(),
            ids: config.servos().map(|servo| servo.id).collect(),
            motion: config.motion_part(),
            stamp: 0.0,
            commanded: 0.0,
            asked: 0.0,
            next_asked: 0,
            fault: None,
            config: config.clone(),
        };
        let opened = hand.set_up().and_then(|()| hand.arm());
        let opened = opened.map_err(|error| hand.blame_adapter(error));
        match opened.and_then(|()| hand.check_latency()) {
            Ok(()) => Ok(hand),
            Err(error) => Err(match hand.disable_torque() {
                Ok(()) => error,
                Err(_) => DriveError::TorqueMayBeOn(Box::new(error)),
            }),
        }
    }

    /// Restarts a hand that was stopped by a fault: restarts servos that an overload has switched off, sets the
    /// watchdogs and switches torque on. Call this only after the cause of the fault was found.
    ///
    /// # Errors
    /// If a servo is faulty, or is in another turn than before; the hand then remains stopped.
    pub fn restart(&mut self) -> Result<(), DriveError> {
        let before: Vec<_> = self.angles().map(|(_, angle)| angle).collect();
        self.power_off();
        self.restart_overloaded()?;
        self.servos.iter_mut().for_each(Servo::reset);
        self.read_servos()?;
        self.check_turns(&before)?;
        self.arm()?;
        self.fault = None;
        Ok(())
    }

    /// Checks that each servo has moved by less than half a turn since its joints were at `before` (rad or m), in the
    /// order of [`angles`](Self::angles). A geared servo that loses count of its turns in a restart reports a wrong joint
    /// angle.
    ///
    /// # Errors
    /// Returns [`DriveError::TurnLost`] for the first joint that has moved further.
    pub fn check_turns(&self, before: &[f64]) -> Result<(), DriveError> {
        let mut joints = self.joints().zip(before);
        joints.try_for_each(|(joint, &before)| joint.check_turn(before))
    }

    /// Message of the fault that stopped the hand, or `None` if it is running.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Age of the latest joint angles, s.
    pub fn age(&self) -> f64 {
        self.clock.now() - self.stamp
    }

    /// Latest position of each joint, rad or m, servo by servo.
    pub fn angles(&self) -> impl Iterator<Item = (JointName, f64)> {
        self.joints().map(|joint| (joint.name, joint.angle))
    }

    /// All joints, servo by servo.
    fn joints(&self) -> impl Iterator<Item = &ServoJoint> {
        self.servos.iter().flat_map(|servo| servo.joints.iter())
    }

    /// Torque of each motor on the first joint that it moves, from its latest current; `None` without a calibration.
    pub fn torques(&self) -> impl Iterator<Item = (JointName, Option<TorqueEstimate>)> {
        let servos = self.servos.iter();
        servos.map(|servo| (servo.name(), servo.torque()))
    }

    /// Reads currents in every period from now on, even if [`DrivesConfig::reads_current`] is `false`. No effect on Feetech
    /// SCS servos, which measure none.
    pub fn read_currents(&mut self) {
        self.motion = Registers::of(self.config.protocol).motion_and_current;
    }

    /// Latest current of each motor, A, positive if it increases the position of the first joint that it moves; 0 if
    /// currents are not read.
    pub fn currents(&self) -> impl Iterator<Item = (JointName, f64)> {
        self.servos
            .iter()
            .map(|servo| (servo.name(), servo.current))
    }

    /// Switches the torque of all servos off, and verifies it. The hand must not be commanded afterwards.
    ///
    /// # Errors
    /// If a servo does not confirm it, for example because the bus has failed: its torque may still be on.
    pub fn disable_torque(&mut self) -> Result<(), DriveError> {
        self.power_off();
        let torque = Registers::of(self.config.protocol).torque;
        for servo in &self.servos {
            set(&mut self.bus, servo.name(), torque, 0)?;
        }
        Ok(())
    }

    fn power_off(&mut self) {
        self.stop_motors();
        let register = Registers::of(self.config.protocol).torque;
        // Sent twice, because sync writes are not acknowledged.
        for _ in 0..2 {
            let off = self.ids.iter().map(|&id| (id, 0));
            let _ = self.bus.sync_write(register, off);
        }
    }

    /// Attributes an error of the bus to the joint of the servo concerned.
    fn blame_by_id(&self, source: BusError) -> DriveError {
        let id = source.servo();
        let servo = self.servos.iter().find(|servo| Some(servo.name().id) == id);
        match servo {
            Some(servo) => blame(servo.name())(source),
            None => source.into(),
        }
    }
}

/// Checks that the values of `config` are in their ranges, for a hand with these `fingers`.
fn check(config: &DrivesConfig, fingers: &[FingerGeometry]) -> Result<(), DriveError> {
    let mut checker = Checker::default();
    let prismatic: Vec<_> = fingers.iter().map(FingerGeometry::is_prismatic).collect();
    config.check("drives", &prismatic, &mut checker);
    checker.finish().map_err(DriveError::Config)
}

impl Drop for DriveHand {
    fn drop(&mut self) {
        self.power_off();
    }
}
