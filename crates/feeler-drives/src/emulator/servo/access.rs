//! Access rules of an emulated servo's control table.

use super::{EmulatedServo, TABLE, error, mode};
use crate::health::OVERLOAD;
use crate::packet::Protocol;
use crate::registers::Register;

/// Maximum goal position in modes without limits, counts: 256 turns.
const MULTI_TURN: i64 = 1_048_575;
/// Value of a Feetech servo's torque register that sets its homing offset.
const SET_MIDDLE: i64 = 128;

impl EmulatedServo {
    /// Writes `bytes` to the control table from `address`. Returns an error number, or 0.
    pub(in crate::emulator) fn write(&mut self, address: usize, bytes: &[u8]) -> u8 {
        let registers = self.registers();
        let Some(end) = address.checked_add(bytes.len()).filter(|&end| end <= TABLE) else {
            return error::ACCESS;
        };
        let part = address..end;
        let is = |register: Register| part.start == usize::from(register.address);
        let torque = self.get(registers.torque) != 0;
        match self.model.protocol {
            Protocol::Dynamixel if address < 7 || end > 120 => return error::ACCESS,
            Protocol::Dynamixel if address < 64 && torque => return error::ACCESS,
            // The factory's registers are writable, too.
            Protocol::Feetech | Protocol::FeetechScs
                if address < 5 || end > 87 || (56..80).contains(&address) =>
            {
                return error::ACCESS;
            }
            // A real servo loses values written to its locked EEPROM on restart; here they are ignored.
            Protocol::Feetech | Protocol::FeetechScs if address < 40 && self.is_locked() => {
                return 0;
            }
            _ => {}
        }
        if let Err(error) = self.check_goal(address, bytes) {
            return error;
        }
        if is(registers.torque) && self.model.protocol == Protocol::Dynamixel {
            // After a shutdown, only a restart restores torque.
            if self.get(registers.fault) != 0 && bytes.first() != Some(&0) {
                return error::ACCESS;
            }
        }
        self.table[part].copy_from_slice(bytes);
        self.react(address);
        0
    }

    /// Returns `true` if the EEPROM is locked.
    fn is_locked(&self) -> bool {
        let lock = self.registers().lock;
        lock.is_some_and(|lock| self.get(lock) != 0)
    }

    /// Checks the value of a goal that an instruction writes to `address`.
    fn check_goal(&self, address: usize, bytes: &[u8]) -> Result<(), u8> {
        let registers = self.registers();
        let limit = registers
            .velocity_limit
            .map_or(self.model.velocity_limit, |limit| self.get(limit));
        let [lower, upper] = registers.position_limits.map(|limit| self.get(limit));
        let within_a_turn = self.mode() == mode::WITHIN_A_TURN;
        let most = registers.current_limit.map_or(0, |limit| self.get(limit));
        let goals = [
            (Some(registers.goal_velocity), -limit..=limit),
            (registers.goal_current, -most..=most),
            (
                Some(registers.goal_position),
                match (self.model.protocol, within_a_turn) {
                    (Protocol::Dynamixel, true) => lower..=upper,
                    (Protocol::Dynamixel, false) => -MULTI_TURN..=MULTI_TURN,
                    // Limited when it is followed.
                    (Protocol::Feetech | Protocol::FeetechScs, _) => i64::MIN..=i64::MAX,
                },
            ),
        ];
        for (register, range) in goals {
            let Some(register) = register.filter(|r| address == usize::from(r.address)) else {
                continue;
            };
            if bytes.len() < register.length {
                return Err(error::LENGTH);
            }
            let watchdog = registers.watchdog.map_or(0, |watchdog| self.get(watchdog));
            if watchdog < 0 {
                return Err(error::RANGE);
            }
            if !range.contains(&register.decode(bytes)) {
                return Err(error::LIMIT);
            }
        }
        Ok(())
    }

    /// Performs the actions that a write to `address` triggers.
    fn react(&mut self, address: usize) {
        let registers = self.registers();
        let is = |register: Register| address == usize::from(register.address);
        match self.model.protocol {
            Protocol::Dynamixel if registers.mode.is_some_and(is) => self.reset_goals(),
            // Position control within a turn forgets turns.
            Protocol::Dynamixel
                if is(registers.torque)
                    && self.mode() == mode::WITHIN_A_TURN
                    && self.get(registers.torque) == 1 =>
            {
                self.forget_turns();
            }
            Protocol::Feetech if is(registers.torque) => match self.get(registers.torque) {
                0 => self.end_overload(),
                SET_MIDDLE => self.set_middle(),
                _ => {}
            },
            Protocol::FeetechScs if is(registers.goal_position) => self.end_overload(),
            _ => {}
        }
    }

    /// Ends an overload, if any.
    fn end_overload(&mut self) {
        let register = self.registers().fault;
        let fault = self.get(register);
        if fault & i64::from(OVERLOAD) != 0 {
            self.put(register, fault & !i64::from(OVERLOAD));
            self.restart_motor();
        }
    }

    /// Sets the homing offset so that the present position becomes the middle of the turn.
    fn set_middle(&mut self) {
        let registers = self.registers();
        let Some(register) = registers.homing_offset else {
            return;
        };
        let turn = self.model.counts;
        let encoder = self.get(registers.position) + self.get(register);
        let offset = encoder.rem_euclid(turn) - turn / 2;
        // Sign and magnitude of 11 bits.
        self.put(register, offset.max(1 - turn / 2));
        self.put(registers.torque, 0);
    }
}
