//! Where servos keep what, and in which units.
//!
//! Dynamixel X series: control tables of the e-Manual, e.g. <https://emanual.robotis.com/docs/en/dxl/x/xl330-m288/>.
//! Feetech: memory table of the STS and SMS series.

mod models;

pub use models::{MODELS, Model};

use crate::packet::Protocol;

/// A value in a servo's control table, least significant byte first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// Where it begins.
    pub address: u16,
    /// Its bytes, 1, 2 or 4.
    pub length: usize,
    /// How it says what is negative.
    pub sign: Sign,
}

/// How a value says what is negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// It never is.
    Unsigned,
    /// Two's complement.
    Two,
    /// This bit says so, and the bits below it how much (Feetech).
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
    /// The value that `bytes` say, of which there are [`length`](Self::length).
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

    /// Appends `value` to `bytes`; what does not fit is cut off.
    pub fn encode(self, value: i64, bytes: &mut Vec<u8>) {
        let raw = match self.sign {
            Sign::Bit(bit) if value < 0 => -value | (1 << bit),
            _ => value,
        };
        bytes.extend_from_slice(&raw.to_le_bytes()[..self.length]);
    }
}

/// Where the servos of a protocol keep what drives need of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Registers {
    /// Model number.
    pub model: Register,
    /// Firmware, by which fast sync reads are possible (Dynamixel).
    pub firmware: Option<Register>,
    /// How long a servo waits before it answers, in 2 us.
    pub return_delay: Register,
    /// What its motor follows: 1 is a velocity.
    pub mode: Register,
    /// Whether its EEPROM is locked (Feetech).
    pub lock: Option<Register>,
    /// Largest current, in the model's unit.
    pub current_limit: Register,
    /// Largest goal velocity, in the model's unit.
    pub velocity_limit: Option<Register>,
    /// Whether the motor has power.
    pub torque: Register,
    /// What is wrong with it.
    pub fault: Register,
    /// Stops the motor when nothing arrives for so long, in 20 ms.
    pub watchdog: Option<Register>,
    /// Goal velocity, in the model's unit.
    pub goal_velocity: Register,
    /// Velocity, in the model's unit.
    pub velocity: Register,
    /// Position, counts.
    pub position: Register,
    /// Supply voltage, 0.1 V.
    pub voltage: Register,
    /// Temperature, degrees Celsius.
    pub temperature: Register,
    /// What is read in every period: the first byte, and how many.
    pub motion: (u16, usize),
    /// Whether `motion` has voltage, temperature and fault, too.
    pub motion_has_health: bool,
}

const DYNAMIXEL: Registers = Registers {
    model: register(0, 2, Sign::Unsigned),
    firmware: Some(register(6, 1, Sign::Unsigned)),
    return_delay: register(9, 1, Sign::Unsigned),
    mode: register(11, 1, Sign::Unsigned),
    lock: None,
    current_limit: register(38, 2, Sign::Unsigned),
    velocity_limit: Some(register(44, 4, Sign::Unsigned)),
    torque: register(64, 1, Sign::Unsigned),
    fault: register(70, 1, Sign::Unsigned),
    watchdog: Some(register(98, 1, Sign::Two)),
    goal_velocity: register(104, 4, Sign::Two),
    velocity: register(128, 4, Sign::Two),
    position: register(132, 4, Sign::Two),
    voltage: register(144, 2, Sign::Unsigned),
    temperature: register(146, 1, Sign::Unsigned),
    motion: (128, 8),
    motion_has_health: false,
};

const FEETECH: Registers = Registers {
    model: register(3, 2, Sign::Unsigned),
    firmware: None,
    return_delay: register(7, 1, Sign::Unsigned),
    mode: register(33, 1, Sign::Unsigned),
    lock: Some(register(55, 1, Sign::Unsigned)),
    current_limit: register(28, 2, Sign::Unsigned),
    velocity_limit: None,
    torque: register(40, 1, Sign::Unsigned),
    fault: register(65, 1, Sign::Unsigned),
    watchdog: None,
    goal_velocity: register(46, 2, Sign::Bit(15)),
    velocity: register(58, 2, Sign::Bit(15)),
    position: register(56, 2, Sign::Bit(15)),
    voltage: register(62, 1, Sign::Unsigned),
    temperature: register(63, 1, Sign::Unsigned),
    motion: (56, 10),
    motion_has_health: true,
};

impl Registers {
    /// Those of the servos that speak `protocol`.
    pub fn of(protocol: Protocol) -> &'static Self {
        match protocol {
            Protocol::Dynamixel => &DYNAMIXEL,
            Protocol::Feetech => &FEETECH,
        }
    }

    /// What `register` says in the bytes that [`motion`](Self::motion) names.
    pub fn in_motion(&self, register: Register, bytes: &[u8]) -> i64 {
        let begin = usize::from(register.address.saturating_sub(self.motion.0));
        register.decode(bytes.get(begin..).unwrap_or_default())
    }
}

/// The operating mode in which a motor follows a velocity, of both protocols.
pub const VELOCITY_MODE: i64 = 1;
/// Time that one count of a Dynamixel's bus watchdog is, s.
pub const WATCHDOG_UNIT: f64 = 0.02;
/// Counts of a turn, of all models known here.
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
    fn values_have_their_signs() {
        there_and_back(DYNAMIXEL.goal_velocity, -2, &[0xFE, 0xFF, 0xFF, 0xFF]);
        there_and_back(DYNAMIXEL.watchdog.expect("one"), -1, &[0xFF]);
        there_and_back(DYNAMIXEL.position, 166, &[0xA6, 0, 0, 0]);
        there_and_back(FEETECH.goal_velocity, -2, &[0x02, 0x80]);
        there_and_back(FEETECH.goal_velocity, 1000, &[0xE8, 0x03]);
    }
}
