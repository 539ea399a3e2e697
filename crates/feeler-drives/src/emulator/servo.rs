//! One emulated servo: its control table, and the rules by which it is read and written.

use super::plant::Motion;
use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Model, Register, Registers, VELOCITY_MODE, WATCHDOG_UNIT};
use std::f64::consts::TAU;

/// Bytes of a control table.
const TABLE: usize = 256;
/// How long a restarted servo is silent, s.
const RESTART: f64 = 0.3;
/// Temperature around a servo, degrees Celsius.
const AMBIENT: f64 = 25.0;
/// How much hotter it gets at its greatest velocity, degrees Celsius.
const HEATING: f64 = 20.0;
/// Time constant of its temperature, s.
const THERMAL_LAG: f64 = 60.0;
/// Supply voltage, 0.1 V.
const SUPPLY: i64 = 50;
/// Errors that a servo answers with (Dynamixel protocol 2.0).
pub(super) mod error {
    pub const INSTRUCTION: u8 = 2;
    pub const RANGE: u8 = 4;
    pub const LENGTH: u8 = 5;
    pub const LIMIT: u8 = 6;
    pub const ACCESS: u8 = 7;
}

/// A servo that is not there.
#[derive(Debug, Clone)]
pub struct EmulatedServo {
    /// Its id.
    pub id: u8,
    /// What it says that it is.
    pub model: &'static Model,
    table: [u8; TABLE],
    /// When it last got an instruction, s.
    heard: f64,
    /// It says nothing until then, s.
    silent_until: f64,
    temperature: f64,
    supply: i64,
    /// By how much its encoder is off, counts.
    pub(super) jump: i64,
}

impl EmulatedServo {
    /// A servo as it comes: in position mode, without torque.
    pub fn new(id: u8, model: &'static Model) -> Self {
        let mut servo = Self {
            id,
            model,
            table: [0; TABLE],
            heard: 0.0,
            silent_until: 0.0,
            temperature: AMBIENT,
            supply: SUPPLY,
            jump: 0,
        };
        let registers = servo.registers();
        servo.put(registers.model, model.number);
        servo.put(registers.current_limit, 500);
        match model.protocol {
            Protocol::Dynamixel => {
                // Firmware, id, return delay of 500 us, position mode.
                (
                    servo.table[6],
                    servo.table[7],
                    servo.table[9],
                    servo.table[11],
                ) = (46, id, 250, 3);
                if let Some(limit) = registers.velocity_limit {
                    servo.put(limit, model.velocity_limit);
                }
            }
            Protocol::Feetech => {
                (servo.table[0], servo.table[1], servo.table[5]) = (3, 10, id);
                servo.table[55] = 1;
            }
        }
        servo
    }

    fn registers(&self) -> &'static Registers {
        Registers::of(self.model.protocol)
    }

    /// The same with another firmware.
    pub fn set_firmware(&mut self, firmware: u8) {
        if let Some(register) = self.registers().firmware {
            self.put(register, firmware.into());
        }
    }

    /// What `register` has.
    pub fn get(&self, register: Register) -> i64 {
        register.decode(&self.table[usize::from(register.address)..])
    }

    fn put(&mut self, register: Register, value: i64) {
        let mut bytes = Vec::with_capacity(8);
        register.encode(value, &mut bytes);
        let begin = usize::from(register.address);
        self.table[begin..begin + bytes.len()].copy_from_slice(&bytes);
    }

    /// The velocity that its motor is to follow, rad/s: none without torque or in another mode.
    pub fn goal(&self) -> f64 {
        let registers = self.registers();
        let on = self.get(registers.torque) != 0 && self.get(registers.mode) == VELOCITY_MODE;
        let units = if on {
            self.get(registers.goal_velocity)
        } else {
            0
        };
        units as f64 * self.model.velocity_unit
    }

    /// Whether it hears and answers at `now`, s.
    pub(super) fn is_there(&self, now: f64) -> bool {
        now >= self.silent_until
    }

    /// Time that it waits before it answers, s.
    pub(super) fn return_delay(&self) -> f64 {
        self.get(self.registers().return_delay) as f64 * 2e-6
    }

    /// Its error byte: with a hardware fault a Dynamixel's has its first bit set, and a Feetech's is the fault.
    pub(super) fn status(&self, error: u8) -> u8 {
        let fault = self.get(self.registers().fault) as u8;
        match self.model.protocol {
            Protocol::Dynamixel if fault != 0 => error | 0x80,
            Protocol::Dynamixel => error,
            Protocol::Feetech => fault,
        }
    }

    /// An instruction arrived at `now`, s.
    pub(super) fn hear(&mut self, now: f64) {
        self.heard = now;
    }

    /// The part of its table from `address` on.
    pub(super) fn read(&self, address: usize, length: usize) -> Option<&[u8]> {
        self.table.get(address..address.checked_add(length)?)
    }

    /// Writes `bytes` from `address` on; an error number, or 0.
    pub(super) fn write(&mut self, address: usize, bytes: &[u8]) -> u8 {
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
            Protocol::Feetech if address < 5 || end > 56 => return error::ACCESS,
            // A locked EEPROM forgets what is written to it; here it does not take it.
            Protocol::Feetech if address < 40 && self.table[55] != 0 => return 0,
            _ => {}
        }
        if is(registers.goal_velocity) {
            let register = registers.goal_velocity;
            if bytes.len() < register.length {
                return error::LENGTH;
            }
            if registers
                .watchdog
                .is_some_and(|watchdog| self.get(watchdog) < 0)
            {
                return error::RANGE;
            }
            let limit = registers
                .velocity_limit
                .map_or(self.model.velocity_limit, |l| self.get(l));
            if register.decode(bytes).abs() > limit {
                return error::LIMIT;
            }
        }
        self.table[part].copy_from_slice(bytes);
        0
    }

    /// Starts afresh at `now`, s.
    pub(super) fn reboot(&mut self, now: f64) {
        let registers = self.registers();
        let first_of_ram = match self.model.protocol {
            Protocol::Dynamixel => 64,
            Protocol::Feetech => 40,
        };
        let lock = registers.lock;
        self.table[first_of_ram..].fill(0);
        if let Some(lock) = lock {
            self.put(lock, 1);
        }
        self.silent_until = now + RESTART;
    }

    /// Says nothing any more.
    pub(super) fn silence(&mut self) {
        self.silent_until = f64::INFINITY;
    }

    pub(super) fn overheat(&mut self) {
        self.temperature = 95.0;
    }

    pub(super) fn lower_supply(&mut self) {
        self.supply = 31;
    }

    /// Reports an overload, with which a real one takes its torque away.
    pub(super) fn break_down(&mut self) {
        let registers = self.registers();
        self.put(registers.fault, 0x20);
        self.put(registers.torque, 0);
    }

    /// What it measures `step` s after the time before, at `now`, s, where its horn has this `motion`; stops its motor where its
    /// watchdog heard nothing for too long.
    pub(super) fn measure(&mut self, (now, step): (f64, f64), motion: Motion, noise: f64) {
        let registers = self.registers();
        if let Some(register) = registers.watchdog {
            let counts = self.get(register);
            if counts > 0 && now - self.heard > counts as f64 * WATCHDOG_UNIT {
                self.put(register, -1);
                self.put(registers.goal_velocity, 0);
            }
        }
        let counts = (motion.angle * COUNTS_PER_TURN / TAU + noise).round() as i64 + self.jump;
        let counts = match self.model.protocol {
            Protocol::Dynamixel => counts,
            Protocol::Feetech => counts.rem_euclid(COUNTS_PER_TURN as i64),
        };
        self.put(registers.position, counts);
        let units = (motion.velocity / self.model.velocity_unit).round() as i64;
        self.put(registers.velocity, units);
        let load = (units as f64 / self.model.velocity_limit as f64)
            .abs()
            .min(1.0);
        let warm = AMBIENT + HEATING * load;
        self.temperature += (warm - self.temperature) * (1.0 - (-step / THERMAL_LAG).exp());
        self.put(registers.temperature, self.temperature.round() as i64);
        self.put(registers.voltage, self.supply);
    }
}
