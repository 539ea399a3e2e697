//! Configures the servos of a hand and switches their torque on.

use super::DriveHand;
use crate::bus::Bus;
use crate::config::JointDriveConfig;
use crate::error::{DriveError, JointName};
use crate::health::OVERLOAD;
use crate::packet::Protocol;
use crate::registers::{DriveMode, GoalKind, Model, Registers};
use crate::servo::{Servo, ServoJoints};
use crate::setup::{
    apply, blame, changes, check_fast_sync_read, check_model, check_velocity_limit, named_servos,
    read, set,
};

/// Time after which a restarted servo must answer, s.
const RESTART: f64 = 1.0;
/// Time between attempts to reach a restarted servo, s.
const RETRY: f64 = 0.05;

impl DriveHand {
    /// Configures the servos, with their torque off.
    pub(super) fn set_up(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        for (joint, drive) in named_servos(&self.config) {
            let model = check_model(&mut self.bus, joint, drive)?;
            if self.config.fast_sync_read {
                check_fast_sync_read(&mut self.bus, joint, model)?;
            }
            let joints = ServoJoints::of(&self.config, &self.fingers, joint)?;
            let range = (joints.limits.lower, joints.limits.upper);
            check_velocity_limit(&mut self.bus, &self.config, &self.fingers, (joint, model))?;
            let servo = Servo::new(joints, model, self.most_age);
            self.bus
                .write(joint.id, registers.torque, 0)
                .map_err(blame(joint))?;
            let changes = changes(&mut self.bus, joint, drive, range)?;
            apply(&mut self.bus, &changes)?;
            check_current_limit(&mut self.bus, joint, drive, model)?;
            self.servos.push(servo);
        }
        Ok(())
    }

    /// Switches torque on, one servo after the other, each once its goal holds its joints and its watchdog is set.
    pub(super) fn arm(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        let watchdog = self.config.watchdog_counts();
        for servo in &mut self.servos {
            servo.reset();
            let joint = servo.name();
            if let Some(register) = registers.watchdog {
                // An expired watchdog rejects goals until it is cleared.
                self.bus
                    .write(joint.id, register, 0)
                    .map_err(blame(joint))?;
            }
            if servo.kind() == GoalKind::Velocity {
                set(&mut self.bus, joint, registers.goal_velocity, 0)?;
            }
        }
        self.read_motion()?;
        for servo in &mut self.servos {
            servo.hold();
            hold(&mut self.bus, servo)?;
        }
        self.commanded = self.stamp;
        for index in 0..self.servos.len() {
            self.check_health(index, false)?;
        }
        for servo in &self.servos {
            let joint = servo.name();
            if let Some(register) = registers.watchdog {
                set(&mut self.bus, joint, register, watchdog)?;
            }
            set(&mut self.bus, joint, registers.torque, 1)?;
        }
        (self.asked, self.next_asked) = (self.clock.now(), 0);
        Ok(())
    }

    /// Restarts Dynamixel servos that an overload has switched off; their torque cannot be enabled otherwise. The
    /// EEPROM keeps its values. Servos with other faults remain off. Feetech servos get a new goal, since that ends an
    /// overload of the SCS0009. Call this only without torque, after the cause of the overload was removed.
    ///
    /// # Errors
    /// If a servo does not answer, or not within a second after its restart.
    pub fn restart_overloaded(&mut self) -> Result<(), DriveError> {
        if self.config.protocol != Protocol::Dynamixel {
            self.servos.iter_mut().for_each(Servo::end_overload);
            return Ok(self.write_goals()?);
        }
        let fault = Registers::of(Protocol::Dynamixel).fault;
        for servo in &self.servos {
            let joint = servo.name();
            if read(&mut self.bus, joint, fault)? != i64::from(OVERLOAD) {
                continue;
            }
            self.bus.reboot(joint.id).map_err(blame(joint))?;
            let until = self.clock.now() + RESTART;
            loop {
                self.bus.wait(RETRY)?;
                match self.bus.ping(joint.id) {
                    Ok(()) => break,
                    Err(_) if self.clock.now() < until => {}
                    Err(error) => return Err(blame(joint)(error)),
                }
            }
        }
        Ok(())
    }
}

/// Writes the goal that holds the joints of `servo`, and the limits of its motion. Velocity goals are already 0.
fn hold(bus: &mut Bus, servo: &Servo) -> Result<(), DriveError> {
    let registers = Registers::of(servo.model.protocol);
    let joint = servo.name();
    if servo.kind() == GoalKind::Velocity {
        return Ok(());
    }
    if let Some(register) = registers.profile_acceleration {
        set(bus, joint, register, 0)?;
    }
    let velocity = servo.profile_velocity();
    set(bus, joint, registers.profile_velocity, velocity)?;
    if let (DriveMode::CurrentLimitedPosition, Some(most)) =
        (servo.drive().mode(), servo.drive().most_current())
    {
        // Rounded down, so that the limit is never exceeded.
        if let Some(register) = registers.goal_current {
            let counts = (most / servo.model.current_unit) as i64;
            set(bus, joint, register, counts)?;
        }
        if let Some(register) = registers.output_limit {
            let (_, stall_current) = servo.model.stall;
            let share = (1000.0 * most / stall_current).min(1000.0) as i64;
            set(bus, joint, register, share)?;
        }
    }
    set(bus, joint, registers.goal_position, servo.goal)
}

/// Checks that the servo of `joint` accepts the goal current of `drive`.
fn check_current_limit(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
    model: &Model,
) -> Result<(), DriveError> {
    let registers = Registers::of(model.protocol);
    let (DriveMode::CurrentLimitedPosition, Some(_), Some(register), Some(expected)) = (
        drive.mode(),
        registers.goal_current,
        registers.current_limit,
        drive.most_current(),
    ) else {
        return Ok(());
    };
    let limit = read(bus, joint, register)?;
    match (expected / model.current_unit) as i64 <= limit {
        true => Ok(()),
        false => Err(DriveError::CurrentLimit {
            joint,
            expected,
            actual: limit as f64 * model.current_unit,
            address: register.address,
        }),
    }
}
