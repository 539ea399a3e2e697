//! Restarts, faults and watchdog of an emulated servo.

use super::{EmulatedServo, mode};
use crate::packet::Protocol;
use crate::registers::WATCHDOG_UNIT;

/// Time for which a restarted servo is silent, s.
const RESTART: f64 = 0.3;

impl EmulatedServo {
    /// Restarts at `now`, s.
    pub(in crate::emulator) fn reboot(&mut self, now: f64) {
        let registers = self.registers();
        let first_of_ram = match self.model.protocol {
            Protocol::Dynamixel => 64,
            Protocol::Feetech | Protocol::FeetechScs => 40,
        };
        let lock = registers.lock;
        let position = self.get(registers.position);
        self.table[first_of_ram..].fill(0);
        if let Some(lock) = lock {
            self.put(lock, 1);
        }
        self.put(registers.position, position);
        if self.model.protocol == Protocol::Dynamixel {
            self.forget_turns();
        }
        self.reset_goals();
        self.motor.restart();
        self.silent_until = now + RESTART;
    }

    /// Stops answering permanently.
    pub(in crate::emulator) fn silence(&mut self) {
        self.silent_until = f64::INFINITY;
    }

    /// Heats the servo above its limit.
    pub(in crate::emulator) fn overheat(&mut self) {
        self.temperature = 95.0;
    }

    /// Lowers the supply voltage below its limit.
    pub(in crate::emulator) fn lower_supply(&mut self) {
        self.supply = 31;
    }

    /// Reports the fault bits `faults` and switches torque off, like a real servo.
    pub(in crate::emulator) fn break_down(&mut self, faults: u8) {
        let registers = self.registers();
        self.put(registers.fault, faults.into());
        self.put(registers.torque, 0);
    }

    /// Stops the motor at its present position if the watchdog has expired at `now`, s.
    pub(super) fn watch(&mut self, now: f64) {
        let registers = self.registers();
        let Some(register) = registers.watchdog else {
            return;
        };
        let counts = self.get(register);
        if counts <= 0 || now - self.heard <= counts as f64 * WATCHDOG_UNIT {
            return;
        }
        self.put(register, -1);
        let (mode, limit) = (self.mode(), registers.goal_current);
        let before = limit.map_or(0, |goal| self.get(goal));
        self.reset_goals();
        if let (Some(goal), mode::CURRENT_LIMITED) = (limit, mode) {
            // The place is held with the current that was allowed.
            self.put(goal, before);
        }
    }

    /// Restarts the count of turns, so that the position without the homing offset is within a turn.
    pub(super) fn forget_turns(&mut self) {
        let registers = self.registers();
        let turn = self.model.counts;
        let offset = registers.homing_offset.map_or(0, |offset| self.get(offset));
        let position = self.get(registers.position) - offset;
        let forgotten = position.div_euclid(turn) * turn;
        self.jump -= forgotten;
        let reported = self.get(registers.position) - forgotten;
        self.put(registers.position, reported);
    }
}
