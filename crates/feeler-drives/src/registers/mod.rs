//! Control tables and units of servos.
//!
//! Dynamixel X series: control tables of the e-Manual, e.g. <https://emanual.robotis.com/docs/en/dxl/x/xl330-m288/>.
//! Feetech: memory table of the STS and SMS series.

mod models;
mod modes;

pub use models::{MODELS, Model};
pub use modes::{DriveMode, GoalKind};

use crate::packet::Protocol;

/// A value in a servo's control table, little-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// Address of the first byte.
    pub address: u16,
    /// Number of bytes: 1, 2 or 4.
    pub length: usize,
    /// Representation of negative values.
    pub sign: Sign,
}

/// Representation of negative values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Values are never negative.
    Unsigned,
    /// Two's complement.
    Two,
    /// Sign and magnitude: this bit is the sign, the bits below it are the magnitude (Feetech).
    Bit(u8),
}

const fn register(address: u16, length: usize, sign: Sign) -> Register {
    Register {
        address,
        length,
        sign,
    }
}

impl Register {
    /// Decodes the value in `bytes`.
    pub fn decode(self, bytes: &[u8]) -> i64 {
        let bytes = bytes.iter().take(self.length).rev();
        let raw = bytes.fold(0i64, |value, &byte| (value << 8) | i64::from(byte));
        match self.sign {
            Sign::Unsigned => raw,
            Sign::Two => {
                let unused = 64 - 8 * self.length as u32;
                (raw << unused) >> unused
            }
            Sign::Bit(bit) if raw & (1 << bit) != 0 => -(raw & !(-1 << bit)),
            Sign::Bit(bit) => raw & !(-1 << bit),
        }
    }

    /// Decodes the value in the `bytes` of a part of the control table that begins at the address `begin`; 0 if the part
    /// does not contain the register.
    pub fn in_part(self, begin: u16, bytes: &[u8]) -> i64 {
        let offset = self.address.checked_sub(begin).map(usize::from);
        self.decode(offset.and_then(|at| bytes.get(at..)).unwrap_or_default())
    }

    /// Appends the encoded `value` to `bytes`; excess bits are truncated.
    pub fn encode(self, value: i64, bytes: &mut Vec<u8>) {
        let raw = match self.sign {
            Sign::Bit(bit) if value < 0 => -value | (1 << bit),
            _ => value,
        };
        bytes.extend_from_slice(&raw.to_le_bytes()[..self.length]);
    }
}

/// Registers used by a hand, for one protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Registers {
    /// Model number.
    pub model: Register,
    /// Firmware version, which determines support of fast sync reads (Dynamixel).
    pub firmware: Option<Register>,
    /// Delay before a response, in units of 2 us.
    pub return_delay: Register,
    /// Operating mode; see [`DriveMode::number`].
    pub mode: Register,
    /// Offset of the position, counts. Dynamixel adds it to the encoder's position, Feetech subtracts it.
    pub homing_offset: Register,
    /// Minimum and maximum goal position within a turn, counts.
    pub position_limits: [Register; 2],
    /// Faults that switch torque off (Dynamixel).
    pub shutdown: Option<Register>,
    /// EEPROM lock, 1 if locked (Feetech).
    pub lock: Option<Register>,
    /// Maximum current, in the model's unit.
    pub current_limit: Register,
    /// Maximum goal velocity, in the model's unit.
    pub velocity_limit: Option<Register>,
    /// Torque, 1 if the motor is powered.
    pub torque: Register,
    /// Fault bits.
    pub fault: Register,
    /// Time without instructions after which the motor stops, in units of 20 ms.
    pub watchdog: Option<Register>,
    /// Goal velocity, in the model's unit.
    pub goal_velocity: Register,
    /// Goal position, counts.
    pub goal_position: Register,
    /// Goal current, in the model's unit; in current-limited position mode the maximum current (Dynamixel).
    pub goal_current: Option<Register>,
    /// Maximum fraction of the motor's voltage in position mode, in units of 0.1 % (Feetech).
    pub output_limit: Option<Register>,
    /// Acceleration of a motion to a goal position; 0 is the maximum.
    pub profile_acceleration: Register,
    /// Velocity of a motion to a goal position, in the model's unit; 0 is the maximum.
    pub profile_velocity: Register,
    /// Current, in the model's unit.
    pub current: Register,
    /// Velocity, in the model's unit.
    pub velocity: Register,
    /// Position, counts.
    pub position: Register,
    /// Supply voltage, 0.1 V.
    pub voltage: Register,
    /// Temperature, degrees Celsius.
    pub temperature: Register,
    /// Part of the control table read in every period: address of the first byte, and number of bytes.
    pub motion: (u16, usize),
    /// Like `motion`, if currents are also read.
    pub motion_and_current: (u16, usize),
    /// `true` if `motion` also contains voltage, temperature and fault bits.
    pub motion_has_health: bool,
}

const DYNAMIXEL: Registers = Registers {
    model: register(0, 2, Sign::Unsigned),
    firmware: Some(register(6, 1, Sign::Unsigned)),
    return_delay: register(9, 1, Sign::Unsigned),
    mode: register(11, 1, Sign::Unsigned),
    homing_offset: register(20, 4, Sign::Two),
    position_limits: [
        register(52, 4, Sign::Unsigned),
        register(48, 4, Sign::Unsigned),
    ],
    shutdown: Some(register(63, 1, Sign::Unsigned)),
    lock: None,
    current_limit: register(38, 2, Sign::Unsigned),
    velocity_limit: Some(register(44, 4, Sign::Unsigned)),
    torque: register(64, 1, Sign::Unsigned),
    fault: register(70, 1, Sign::Unsigned),
    watchdog: Some(register(98, 1, Sign::Two)),
    goal_velocity: register(104, 4, Sign::Two),
    goal_position: register(116, 4, Sign::Two),
    goal_current: Some(register(102, 2, Sign::Two)),
    output_limit: None,
    profile_acceleration: register(108, 4, Sign::Unsigned),
    profile_velocity: register(112, 4, Sign::Unsigned),
    current: register(126, 2, Sign::Two),
    velocity: register(128, 4, Sign::Two),
    position: register(132, 4, Sign::Two),
    voltage: register(144, 2, Sign::Unsigned),
    temperature: register(146, 1, Sign::Unsigned),
    motion: (128, 8),
    motion_and_current: (126, 10),
    motion_has_health: false,
};

const FEETECH: Registers = Registers {
    model: register(3, 2, Sign::Unsigned),
    firmware: None,
    return_delay: register(7, 1, Sign::Unsigned),
    mode: register(33, 1, Sign::Unsigned),
    homing_offset: register(31, 2, Sign::Bit(11)),
    position_limits: [
        register(9, 2, Sign::Unsigned),
        register(11, 2, Sign::Unsigned),
    ],
    shutdown: None,
    lock: Some(register(55, 1, Sign::Unsigned)),
    current_limit: register(28, 2, Sign::Unsigned),
    velocity_limit: None,
    torque: register(40, 1, Sign::Unsigned),
    fault: register(65, 1, Sign::Unsigned),
    watchdog: None,
    goal_velocity: register(46, 2, Sign::Bit(15)),
    goal_position: register(42, 2, Sign::Bit(15)),
    goal_current: None,
    output_limit: Some(register(48, 2, Sign::Unsigned)),
    profile_acceleration: register(41, 1, Sign::Unsigned),
    profile_velocity: register(46, 2, Sign::Bit(15)),
    current: register(69, 2, Sign::Bit(15)),
    velocity: register(58, 2, Sign::Bit(15)),
    position: register(56, 2, Sign::Bit(15)),
    voltage: register(62, 1, Sign::Unsigned),
    temperature: register(63, 1, Sign::Unsigned),
    motion: (56, 10),
    motion_and_current: (56, 15),
    motion_has_health: true,
};

impl Registers {
    /// Returns the registers of servos with `protocol`.
    pub fn of(protocol: Protocol) -> &'static Self {
        match protocol {
            Protocol::Dynamixel => &DYNAMIXEL,
            Protocol::Feetech => &FEETECH,
        }
    }
}

/// Unit of a Dynamixel's bus watchdog, s.
pub const WATCHDOG_UNIT: f64 = 0.02;
/// Position counts per turn, for all known models.
pub const COUNTS_PER_TURN: f64 = 4096.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn there_and_back(register: Register, value: i64, expected: &[u8]) {
        let mut bytes = Vec::new();
        register.encode(value, &mut bytes);
        assert_eq!(bytes, expected);
        assert_eq!(register.decode(&bytes), value);
    }

    #[test]
    fn encodes_and_decodes_signed_values() {
        there_and_back(DYNAMIXEL.goal_velocity, -2, &[0xFE, 0xFF, 0xFF, 0xFF]);
        there_and_back(DYNAMIXEL.watchdog.expect("one"), -1, &[0xFF]);
        there_and_back(DYNAMIXEL.position, 166, &[0xA6, 0, 0, 0]);
        there_and_back(FEETECH.goal_velocity, -2, &[0x02, 0x80]);
        there_and_back(FEETECH.goal_velocity, 1000, &[0xE8, 0x03]);
        there_and_back(DYNAMIXEL.homing_offset, -4096, &[0x00, 0xF0, 0xFF, 0xFF]);
        there_and_back(DYNAMIXEL.current, -1, &[0xFF, 0xFF]);
        there_and_back(FEETECH.homing_offset, -2047, &[0xFF, 0x0F]);
        there_and_back(FEETECH.homing_offset, 2047, &[0xFF, 0x07]);
        there_and_back(FEETECH.current, -300, &[0x2C, 0x81]);
    }

    /// Without currents, the part begins after a Dynamixel's current and ends before a Feetech's.
    #[test]
    fn registers_outside_of_a_part_are_zero() {
        for registers in [DYNAMIXEL, FEETECH] {
            for ((begin, length), has_current) in [
                (registers.motion, false),
                (registers.motion_and_current, true),
            ] {
                let bytes = vec![1; length];
                assert_ne!(registers.velocity.in_part(begin, &bytes), 0);
                let current = registers.current.in_part(begin, &bytes);
                assert_eq!(current, if has_current { 0x0101 } else { 0 });
            }
        }
    }

    /// Sign and magnitude have two zeros.
    #[test]
    fn negative_zero_is_zero() {
        assert_eq!(FEETECH.homing_offset.decode(&[0x00, 0x08]), 0);
        assert_eq!(FEETECH.position.decode(&[0x00, 0x80]), 0);
    }
}
