//! Emulated servo: its control table and access rules.

use super::plant::Motion;
use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Model, Register, Registers, VELOCITY_MODE, WATCHDOG_UNIT};
use std::f64::consts::TAU;

/// Size of a control table, bytes.
const TABLE: usize = 256;
/// Time for which a restarted servo is silent, s.
const RESTART: f64 = 0.3;
/// Ambient temperature, degrees Celsius.
const AMBIENT: f64 = 25.0;
/// Temperature rise at maximum velocity, degrees Celsius.
const HEATING: f64 = 20.0;
/// Time constant of the temperature, s.
const THERMAL_LAG: f64 = 60.0;
/// Supply voltage, 0.1 V.
const SUPPLY: i64 = 50;
/// Error numbers of responses (Dynamixel protocol 2.0).
pub(super) mod error {
    pub const INSTRUCTION: u8 = 2;
    pub const RANGE: u8 = 4;
    pub const LENGTH: u8 = 5;
    pub const LIMIT: u8 = 6;
    pub const ACCESS: u8 = 7;
}

/// An emulated servo.
#[derive(Debug, Clone)]
pub struct EmulatedServo {
    /// Id on the bus.
    pub id: u8,
    /// Reported model.
    pub model: &'static Model,
    table: [u8; TABLE],
    /// Time of the last instruction, s.
    heard: f64,
    /// Time until which the servo is silent, s.
    silent_until: f64,
    temperature: f64,
    supply: i64,
    /// Encoder offset, counts.
    pub(super) jump: i64,
}

impl EmulatedServo {
    /// Creates a servo in its delivery state: position mode, no torque.
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

    /// Sets the firmware version.
    pub fn set_firmware(&mut self, firmware: u8) {
        if let Some(register) = self.registers().firmware {
            self.put(register, firmware.into());
        }
    }

    /// Returns the value of `register`.
    pub fn get(&self, register: Register) -> i64 {
        register.decode(&self.table[usize::from(register.address)..])
    }

    fn put(&mut self, register: Register, value: i64) {
        let mut bytes = Vec::with_capacity(8);
        register.encode(value, &mut bytes);
        let begin = usize::from(register.address);
        self.table[begin..begin + bytes.len()].copy_from_slice(&bytes);
    }

    /// Goal velocity of the motor, rad/s; 0 without torque or in another mode.
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

    /// Returns `true` if the servo receives and answers at `now`, s.
    pub(super) fn is_there(&self, now: f64) -> bool {
        now >= self.silent_until
    }

    /// Delay before a response, s.
    pub(super) fn return_delay(&self) -> f64 {
        self.get(self.registers().return_delay) as f64 * 2e-6
    }

    /// Error byte of a response. Dynamixel: the top bit is set on a hardware fault. Feetech: the fault bits.
    pub(super) fn status(&self, error: u8) -> u8 {
        let fault = self.get(self.registers().fault) as u8;
        match self.model.protocol {
            Protocol::Dynamixel if fault != 0 => error | 0x80,
            Protocol::Dynamixel => error,
            Protocol::Feetech => fault,
        }
    }

    /// Registers that an instruction arrived at `now`, s.
    pub(super) fn hear(&mut self, now: f64) {
        self.heard = now;
    }

    /// Reads `length` bytes of the control table from `address`.
    pub(super) fn read(&self, address: usize, length: usize) -> Option<&[u8]> {
        self.table.get(address..address.checked_add(length)?)
    }

    /// Writes `bytes` to the control table from `address`. Returns an error number, or 0.
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
            // A real servo loses values written to its locked EEPROM on restart; here they are ignored.
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

    /// Restarts at `now`, s.
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

    /// Stops answering for good.
    pub(super) fn silence(&mut self) {
        self.silent_until = f64::INFINITY;
    }

    pub(super) fn overheat(&mut self) {
        self.temperature = 95.0;
    }

    pub(super) fn lower_supply(&mut self) {
        self.supply = 31;
    }

    /// Reports an overload, on which a real servo switches its torque off.
    pub(super) fn break_down(&mut self) {
        let registers = self.registers();
        self.put(registers.fault, 0x20);
        self.put(registers.torque, 0);
    }

    /// Updates the measured values at `now` (s), `step` after the previous update, for the `motion` of the horn. Stops
    /// the motor if the watchdog has expired.
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
