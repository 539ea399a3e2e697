//! The servos of a bus as feeler's hand.

use crate::bus::{ALERT, Bus, BusError};
use crate::clock::RigClock;
use crate::config::DrivesConfig;
use crate::error::{DriveError, JointName};
use crate::health::{Health, fault_names};
use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Registers};
use crate::servo::Servo;
use crate::setup::{apply, blame, changes, check_model, named_joints, set};
use feeler::check::Checker;
use feeler::hand::finger::FingerGeometry;
use feeler::hand::{Hand, HandCommand, HandError, HandState, check_finger_count};
use glam::DVec3;

/// Greatest speed of a jogged joint, rad/s.
pub const JOG_SPEED: f64 = 0.2;
/// How many times a joint's greatest speed one may seem to turn: overshoot, and the unit of velocity.
const SPEED_TOLERANCE: f64 = 2.0;
/// Bytes of a Dynamixel's table from its torque to its bus watchdog, and from its voltage to its temperature.
const TORQUE_TO_WATCHDOG: (u16, usize) = (64, 35);
const VOLTAGE_TO_TEMPERATURE: (u16, usize) = (144, 3);

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
    /// When a servo was last asked for its health, and which one is next.
    health: (f64, usize),
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
        let mut checker = Checker::default();
        config.check("drives", fingers.len(), &mut checker);
        let problems = checker.problems();
        if !problems.is_empty() {
            return Err(DriveError::Config(problems));
        }
        let how = (config.protocol, config.baud_rate);
        let bus = Bus::open(&config.port, how, config.reply_timeout, clock)?;
        let mut hand = Self {
            bus,
            clock,
            most_age,
            fingers: fingers.len(),
            servos: Vec::new(),
            ids: config.joints().map(|joint| joint.id).collect(),
            stamp: 0.0,
            health: (0.0, 0),
            fault: None,
            config: config.clone(),
        };
        hand.set_up(fingers)?;
        hand.arm()?;
        Ok(hand)
    }

    /// Sets the servos, whose motors have no power meanwhile.
    fn set_up(&mut self, fingers: &[FingerGeometry]) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        for (joint, drive) in named_joints(&self.config) {
            let model = check_model(&mut self.bus, joint, drive)?;
            let Some(geometry) = fingers.get(joint.finger) else {
                continue;
            };
            let servo = Servo::new(joint, drive, model, geometry);
            if let Some(limit) = registers.velocity_limit {
                let actual = self.bus.read(joint.id, limit).map_err(blame(joint))?;
                servo.allow(actual)?;
            }
            self.bus
                .write(joint.id, registers.torque, 0)
                .map_err(blame(joint))?;
            let changes = changes(&mut self.bus, joint, drive)?;
            apply(&mut self.bus, &changes)?;
            self.servos.push(servo);
        }
        Ok(())
    }

    /// Gives the motors power, each after its watchdog is set.
    fn arm(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        let watchdog = self.config.watchdog_counts();
        for servo in &mut self.servos {
            servo.reset();
            let joint = servo.name;
            if let Some(register) = registers.watchdog {
                // One that has fired takes no goal before it is cleared.
                self.bus
                    .write(joint.id, register, 0)
                    .map_err(blame(joint))?;
            }
            set(
                &mut self.bus,
                joint,
                ("Goal Velocity", registers.goal_velocity),
                0,
            )?;
        }
        self.read_motion()?;
        for index in 0..self.servos.len() {
            self.check_health(index, false)?;
        }
        for servo in &self.servos {
            let joint = servo.name;
            if let Some(register) = registers.watchdog {
                set(&mut self.bus, joint, ("Bus Watchdog", register), watchdog)?;
            }
            set(&mut self.bus, joint, ("Torque Enable", registers.torque), 1)?;
        }
        self.health = (self.clock.now(), 0);
        Ok(())
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

    /// The joint angles of each finger as of the newest reading, rad.
    pub fn angles(&self) -> impl Iterator<Item = (JointName, f64)> {
        self.servos.iter().map(|servo| (servo.name, servo.angle))
    }

    /// Turns one joint at `velocity`, rad/s, at most [`JOG_SPEED`], until the next command; all others stand still. For whoever sets a rig
    /// up; a program that controls a hand has [`Hand::command`].
    ///
    /// # Errors
    /// When there is no such joint, or as [`Hand::command`].
    pub fn jog(&mut self, finger: usize, joint: usize, velocity: f64) -> Result<(), DriveError> {
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
        self.send(|other| if other == index { velocity } else { 0.0 })
    }

    /// Reads all joints.
    fn read_motion(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        let (ids, fast) = (&self.ids, self.config.fast_sync_read);
        let servos = &mut self.servos;
        let mut first_bad = None;
        let limits = self.config.health_limits();
        let protocol = self.config.protocol;
        let read = self
            .bus
            .sync_read(registers.motion, ids, fast, |index, error, bytes| {
                let Some(servo) = servos.get_mut(index) else {
                    return;
                };
                let wraps = protocol == Protocol::Feetech;
                servo.read(registers, bytes, wraps.then_some(COUNTS_PER_TURN as i64));
                let health = Health::in_motion(registers, bytes);
                let ill = registers.motion_has_health
                    && health.check(protocol, servo.name, &limits).is_err();
                if first_bad.is_none() && (error != 0 || ill) {
                    first_bad = Some((index, error, health));
                }
            });
        read.map_err(|source| self.blame_by_id(source))?;
        self.stamp = self.clock.now();
        if let Some((index, error, health)) = first_bad {
            self.explain(index, error, health)?;
        }
        let tolerance = self.config.limit_tolerance;
        self.servos
            .iter()
            .try_for_each(|servo| servo.check(tolerance, SPEED_TOLERANCE))
    }

    /// Says what is wrong with a servo that flagged a fault in its answer.
    fn explain(&mut self, index: usize, error: u8, health: Health) -> Result<(), DriveError> {
        let joint = self.servos[index].name;
        let protocol = self.config.protocol;
        let limits = self.config.health_limits();
        if protocol == Protocol::Feetech {
            let fault = error | health.fault;
            return Health { fault, ..health }.check(protocol, joint, &limits);
        }
        let registers = Registers::of(protocol);
        if error & ALERT == 0 {
            let (id, what) = (joint.id, "a reading");
            return Err(blame(joint)(BusError::Refused { id, what, error }));
        }
        let bits = self
            .bus
            .read(joint.id, registers.fault)
            .map_err(blame(joint))? as u8;
        Err(DriveError::Fault {
            joint,
            faults: fault_names(protocol, bits),
            bits,
        })
    }

    /// Asks a servo whether it is well, and, where it should be `armed`, whether it has its torque and its watchdog.
    fn check_health(&mut self, index: usize, armed: bool) -> Result<(), DriveError> {
        let Some(servo) = self.servos.get(index) else {
            return Ok(());
        };
        let (joint, protocol) = (servo.name, self.config.protocol);
        let registers = Registers::of(protocol);
        if protocol == Protocol::Feetech {
            // The rest is read in every period.
            let torque = self
                .bus
                .read(joint.id, registers.torque)
                .map_err(blame(joint))?;
            return match armed && torque == 0 {
                true => Err(DriveError::TorqueOff { joint }),
                false => Ok(()),
            };
        }
        let part = TORQUE_TO_WATCHDOG;
        let bytes = self.bus.read_bytes(joint.id, part).map_err(blame(joint))?;
        let at = |address: u16| {
            bytes
                .get(usize::from(address - part.0))
                .copied()
                .unwrap_or(0)
        };
        let (torque, fault) = (at(registers.torque.address), at(registers.fault.address));
        let watchdog = registers.watchdog.map(|r| r.decode(&[at(r.address)]));
        let part = VOLTAGE_TO_TEMPERATURE;
        let bytes = self.bus.read_bytes(joint.id, part).map_err(blame(joint))?;
        let health = Health {
            fault,
            voltage: registers.voltage.decode(&bytes[..2]) as f64 / 10.0,
            temperature: registers.temperature.decode(&bytes[2..]) as f64,
        };
        health.check(protocol, joint, &self.config.health_limits())?;
        let expected = self.config.watchdog_counts();
        match watchdog {
            _ if !armed => Ok(()),
            _ if torque == 0 => Err(DriveError::TorqueOff { joint }),
            Some(actual) if actual != expected => Err(DriveError::Watchdog {
                joint,
                expected,
                actual,
            }),
            _ => Ok(()),
        }
    }

    /// Sends each joint its `velocity`, rad/s, by its number, unless the joint angles that it was made of are too old.
    fn send(&mut self, velocity: impl Fn(usize) -> f64) -> Result<(), DriveError> {
        let joints = 0..self.servos.len();
        let moving = joints.into_iter().any(|index| velocity(index) != 0.0);
        let age = self.clock.now() - self.stamp;
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
        let now = self.clock.now();
        let (asked, next) = self.health;
        if now - asked >= self.config.health_interval {
            self.health = (now, (next + 1) % self.servos.len().max(1));
            self.check_health(next, true)?;
        }
        Ok(())
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
