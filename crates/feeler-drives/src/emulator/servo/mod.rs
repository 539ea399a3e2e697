//! Emulated servo: its control table, measured values and faults.

mod access;
mod faults;
mod motion;

use super::motor::{Motor, Wish};
use super::plant::Motion;
use crate::packet::Protocol;
use crate::registers::{Model, Register, Registers};

/// Size of a control table, bytes.
const TABLE: usize = 256;
/// Ambient temperature, degrees Celsius.
const AMBIENT: f64 = 25.0;
/// Temperature rise at maximum velocity, degrees Celsius.
const HEATING: f64 = 20.0;
/// Time constant of the temperature, s.
const THERMAL_LAG: f64 = 60.0;
/// Supply voltage, 0.1 V.
const SUPPLY: i64 = 50;
/// Maximum effective homing offset in single-turn position mode, counts; greater offsets are ignored.
const QUARTER_TURN: f64 = 1024.0;
/// Operating modes of Dynamixel servos with special rules.
mod mode {
    pub const CURRENT: i64 = 0;
    pub const WITHIN_A_TURN: i64 = 3;
    pub const CURRENT_LIMITED: i64 = 5;
}
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
    /// Offset of the encoder's position, counts: turns lost by restarts, and injected jumps.
    pub(super) jump: i64,
    /// External torque on the horn, N m, in addition to the plant's.
    pub(super) load: f64,
    motor: Motor,
}

impl EmulatedServo {
    /// Creates a servo in its factory state: position mode, torque off.
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
            load: 0.0,
            motor: Motor::new(model),
        };
        let registers = servo.registers();
        servo.put(registers.model, model.number);
        if let Some(limit) = registers.current_limit {
            servo.put(limit, 500);
        }
        servo.put(registers.position_limits[1], model.counts - 1);
        if let Some(lock) = registers.lock {
            servo.put(lock, 1);
        }
        if let Some(shutdown) = registers.shutdown {
            // Overload, electrical shock, overheating.
            servo.put(shutdown, 0x34);
        }
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
            Protocol::Feetech | Protocol::FeetechScs => {
                (servo.table[0], servo.table[1], servo.table[5]) = (3, 10, id);
            }
        }
        servo.reset_goals();
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

    /// Operating mode; 0, a position mode, if the servo has no other.
    fn mode(&self) -> i64 {
        self.registers().mode.map_or(0, |mode| self.get(mode))
    }

    fn put(&mut self, register: Register, value: i64) {
        let mut bytes = Vec::with_capacity(8);
        register.encode(value, &mut bytes);
        let begin = usize::from(register.address);
        self.table[begin..begin + bytes.len()].copy_from_slice(&bytes);
    }

    /// Goal velocity of the motor, rad/s; 0 without torque or in another mode.
    pub fn goal(&self) -> f64 {
        match self.wish(0.0) {
            Some(Wish::Velocity(velocity)) => velocity,
            _ => 0.0,
        }
    }

    /// Greatest current of the motor so far, A.
    pub fn greatest_current(&self) -> f64 {
        self.motor.greatest_current
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
            Protocol::Feetech | Protocol::FeetechScs => fault,
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

    /// Position that the servo reports for the encoder's position in `counts`: offsets are added, and it is wrapped to
    /// one turn if the servo's positions wrap. A potentiometer reports its end if the horn is beyond it.
    fn reported(&self, counts: f64) -> f64 {
        let offset = self.registers().homing_offset;
        let offset = offset.map_or(0, |offset| self.get(offset)) as f64;
        let counts = counts + self.jump as f64;
        let within_a_turn = self.mode() == mode::WITHIN_A_TURN;
        let turn = self.model.counts as f64;
        match self.model.protocol {
            Protocol::Dynamixel if within_a_turn && offset.abs() > QUARTER_TURN => counts,
            Protocol::Dynamixel => counts + offset,
            Protocol::Feetech => (counts - offset).rem_euclid(turn),
            Protocol::FeetechScs => counts.clamp(0.0, turn - 1.0),
        }
    }

    /// Resets the goals after torque is switched on or the mode is changed.
    fn reset_goals(&mut self) {
        let registers = self.registers();
        self.put(registers.goal_velocity, 0);
        let position = self.get(registers.position);
        self.put(registers.goal_position, position);
        if let (Some(goal), Some(limit)) = (registers.goal_current, registers.current_limit) {
            let limit = self.get(limit);
            let is_limited = self.mode() == mode::CURRENT_LIMITED;
            self.put(goal, if is_limited { limit } else { 0 });
        }
        if let Some(limit) = registers.output_limit {
            self.put(limit, 1000);
        }
    }

    /// Updates the measured values at `now` (s), `step` after the previous update, for the `motion` of the horn, with noise
    /// of the position (counts) and of the current (relative to the stall current). Stops the motor if the watchdog has
    /// expired.
    pub(super) fn measure(
        &mut self,
        now: f64,
        step: f64,
        motion: Motion,
        noise: f64,
        current_noise: f64,
    ) {
        let registers = self.registers();
        self.watch(now);
        let counts = (self.model.to_counts(motion.angle) + noise).round();
        let counts = self.reported(counts) as i64;
        self.put(registers.position, counts);
        let units = (motion.velocity / self.model.velocity_unit).round() as i64;
        self.put(registers.velocity, units);
        // A motor without torque carries no current.
        let current_noise = match self.get(registers.torque) {
            0 => 0.0,
            _ => current_noise * self.model.stall.1,
        };
        if let Some(register) = registers.current {
            let current = (self.motor.current + current_noise) / self.model.current_unit;
            self.put(register, current.round() as i64);
        }
        let load = (units as f64 / self.model.velocity_limit as f64)
            .abs()
            .min(1.0);
        let warm = AMBIENT + HEATING * load;
        self.temperature += (warm - self.temperature) * (1.0 - (-step / THERMAL_LAG).exp());
        self.put(registers.temperature, self.temperature.round() as i64);
        self.put(registers.voltage, self.supply);
    }
}
