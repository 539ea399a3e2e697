//! Reads the servos in each period and checks their health.

use super::DriveHand;
use crate::bus::{ALERT, BusError};
use crate::error::{DriveError, JointName};
use crate::health::{Health, fault_names};
use crate::packet::Protocol;
use crate::registers::{Register, Registers, TORQUE_TO_WATCHDOG, VOLTAGE_TO_TEMPERATURE};
use crate::setup::{blame, read};

/// Maximum plausible measured velocity, relative to the joint's speed limit; allows for overshoot.
const SPEED_TOLERANCE: f64 = 2.0;

impl DriveHand {
    /// Reads position and velocity of all joints, and checks them.
    pub(super) fn read_motion(&mut self) -> Result<(), DriveError> {
        self.read_servos()?;
        let tolerance = self.config.limit_tolerance;
        self.joints()
            .try_for_each(|joint| joint.check(tolerance, SPEED_TOLERANCE))
    }

    /// Reads position and velocity of all joints, and checks the health reported with them.
    pub(super) fn read_servos(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        let (ids, fast) = (&self.ids, self.config.fast_sync_read);
        let servos = &mut self.servos;
        let mut first_bad = None;
        let limits = self.config.health_limits();
        let protocol = self.config.protocol;
        let part = self.motion;
        let read = self.bus.read_all(part, ids, fast, |index, error, bytes| {
            let Some(servo) = servos.get_mut(index) else {
                return;
            };
            servo.read(part.0, bytes);
            let health = Health::in_motion(registers, bytes);
            let ill = registers.motion_has_health
                && health.check(protocol, servo.name(), &limits).is_err();
            if registers.motion_has_health {
                servo.notice(error | health.fault);
            }
            if first_bad.is_none() && (error != 0 || ill) {
                first_bad = Some((index, error, health));
            }
        });
        self.stamp = read.map_err(|source| self.blame_by_id(source))?;
        match first_bad {
            Some((index, error, health)) => self.explain(index, error, health),
            None => Ok(()),
        }
    }

    /// Returns the error for a servo that reported a fault in its response.
    fn explain(&mut self, index: usize, error: u8, health: Health) -> Result<(), DriveError> {
        let joint = self.servos[index].name();
        let protocol = self.config.protocol;
        let limits = self.config.health_limits();
        if protocol != Protocol::Dynamixel {
            let fault = error | health.fault;
            return Health { fault, ..health }.check(protocol, joint, &limits);
        }
        let registers = Registers::of(protocol);
        if error & ALERT == 0 {
            let (id, what) = (joint.id, "a read");
            return Err(blame(joint)(BusError::Refused { id, what, error }));
        }
        let bits = read(&mut self.bus, joint, registers.fault)? as u8;
        Err(DriveError::Fault {
            joint,
            faults: fault_names(protocol, bits),
            bits,
        })
    }

    /// Checks the health of servo `index` if the health interval has elapsed.
    pub(super) fn check_health_if_due(&mut self, index: usize) -> Result<(), DriveError> {
        let now = self.clock.now();
        if now - self.asked < self.config.health_interval {
            return Ok(());
        }
        self.asked = now;
        self.next_asked = (index + 1) % self.servos.len().max(1);
        self.check_health(index, true)
    }

    /// Checks the health of a servo and, if it should be `armed`, its torque and watchdog.
    pub(super) fn check_health(&mut self, index: usize, armed: bool) -> Result<(), DriveError> {
        let Some(servo) = self.servos.get(index) else {
            return Ok(());
        };
        let joint = servo.name();
        let (torque, watchdog) = match self.config.protocol {
            Protocol::Dynamixel => self.ask_dynamixel(joint)?,
            // The rest is read in every period.
            Protocol::Feetech | Protocol::FeetechScs => {
                let torque = Registers::of(self.config.protocol).torque;
                (read(&mut self.bus, joint, torque)?, None)
            }
        };
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

    /// Checks the health of a Dynamixel. Returns its torque and watchdog registers.
    fn ask_dynamixel(&mut self, joint: JointName) -> Result<(i64, Option<i64>), DriveError> {
        let registers = Registers::of(Protocol::Dynamixel);
        let part = TORQUE_TO_WATCHDOG;
        let bytes = self.bus.read_bytes(joint.id, part).map_err(blame(joint))?;
        let at = |register: Register| register.in_part(part.0, bytes);
        let (torque, fault) = (at(registers.torque), at(registers.fault));
        let watchdog = registers.watchdog.map(at);
        let part = VOLTAGE_TO_TEMPERATURE;
        let bytes = self.bus.read_bytes(joint.id, part).map_err(blame(joint))?;
        let at = |register: Register| register.in_part(part.0, bytes);
        let health = Health::of(fault, at(registers.temperature), at(registers.voltage));
        health.check(Protocol::Dynamixel, joint, &self.config.health_limits())?;
        Ok((torque, watchdog))
    }
}
