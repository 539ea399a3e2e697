//! Configures the servos of a hand and switches their torque on.

use super::DriveHand;
use crate::error::DriveError;
use crate::registers::Registers;
use crate::servo::Servo;
use crate::setup::{
    apply, blame, changes, check_fast_sync_read, check_model, named_joints, read, set,
};

impl DriveHand {
    /// Configures the servos, with their torque off.
    pub(super) fn set_up(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        for (joint, drive) in named_joints(&self.config) {
            let model = check_model(&mut self.bus, joint, drive)?;
            if self.config.fast_sync_read {
                check_fast_sync_read(&mut self.bus, joint, model)?;
            }
            let Some(geometry) = self.fingers.get(joint.finger) else {
                continue;
            };
            let servo = Servo::new(joint, drive, model, geometry);
            if let Some(limit) = registers.velocity_limit {
                servo.allow(read(&mut self.bus, joint, limit)?)?;
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

    /// Switches torque on, each servo after its watchdog is set.
    pub(super) fn arm(&mut self) -> Result<(), DriveError> {
        let registers = Registers::of(self.config.protocol);
        let watchdog = self.config.watchdog_counts();
        for servo in &mut self.servos {
            servo.reset();
            let joint = servo.name;
            if let Some(register) = registers.watchdog {
                // An expired watchdog rejects goals until it is cleared.
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
        (self.asked, self.next_asked) = (self.clock.now(), 0);
        Ok(())
    }
}
