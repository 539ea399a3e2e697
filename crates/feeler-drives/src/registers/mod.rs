//! Control tables and units of servos.
//!
//! Dynamixel X series: control tables of the e-Manual, e.g. <https://emanual.robotis.com/docs/en/dxl/x/xl330-m288/>.
//! Feetech: memory tables of the STS and SMS series, and of the SCS series (in the edition with FD 1.9.8). Names are
//! LeRobot's.

mod models;
mod modes;
mod register;
mod tables;

pub use models::{MODELS, Model};
pub use modes::{DriveMode, GoalKind};
pub use register::{ByteOrder, Register, Sign};

use crate::packet::Protocol;
use tables::{DYNAMIXEL, FEETECH, FEETECH_SCS};

/// Registers used by a hand, for one protocol. `None` if servos with this protocol do not have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Registers {
    /// Model number.
    pub model: Register,
    /// Firmware version, which determines support of fast sync reads (Dynamixel).
    pub firmware: Option<Register>,
    /// Delay before a response, in units of 2 us.
    pub return_delay: Register,
    /// Operating mode; see [`DriveMode::number`].
    pub mode: Option<Register>,
    /// Offset of the position, counts. Dynamixel adds it to the encoder's position, Feetech subtracts it.
    pub homing_offset: Option<Register>,
    /// Minimum and maximum goal position within a turn, counts.
    pub position_limits: [Register; 2],
    /// Faults that switch torque off (Dynamixel).
    pub shutdown: Option<Register>,
    /// EEPROM lock, 1 if locked (Feetech).
    pub lock: Option<Register>,
    /// Maximum current, in the model's unit.
    pub current_limit: Option<Register>,
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
    /// Maximum fraction of the motor's voltage in position mode, in units of 0.1 % (Feetech STS).
    pub output_limit: Option<Register>,
    /// Acceleration of a motion to a goal position; 0 is the maximum.
    pub profile_acceleration: Option<Register>,
    /// Velocity of a motion to a goal position, in the model's unit; 0 is the maximum.
    pub profile_velocity: Register,
    /// Current, in the model's unit.
    pub current: Option<Register>,
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

impl Registers {
    /// Returns the registers of servos with `protocol`.
    pub fn of(protocol: Protocol) -> &'static Self {
        match protocol {
            Protocol::Dynamixel => &DYNAMIXEL,
            Protocol::Feetech => &FEETECH,
            Protocol::FeetechScs => &FEETECH_SCS,
        }
    }
}

/// Unit of a Dynamixel's bus watchdog, s.
pub const WATCHDOG_UNIT: f64 = 0.02;
/// Part (address, length) of a Dynamixel's control table from torque to bus watchdog.
pub(crate) const TORQUE_TO_WATCHDOG: (u16, usize) = (64, 35);
/// Part (address, length) of a Dynamixel's control table from voltage to temperature.
pub(crate) const VOLTAGE_TO_TEMPERATURE: (u16, usize) = (144, 3);

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
        let homing_offset = DYNAMIXEL.homing_offset.expect("one");
        there_and_back(homing_offset, -4096, &[0x00, 0xF0, 0xFF, 0xFF]);
        there_and_back(DYNAMIXEL.current.expect("one"), -1, &[0xFF, 0xFF]);
        let homing_offset = FEETECH.homing_offset.expect("one");
        there_and_back(homing_offset, -2047, &[0xFF, 0x0F]);
        there_and_back(homing_offset, 2047, &[0xFF, 0x07]);
        there_and_back(FEETECH.current.expect("one"), -300, &[0x2C, 0x81]);
        // The model number that LeRobot lists for the SCS0009, 1284, is version 5.4.
        there_and_back(FEETECH_SCS.model, 1284, &[5, 4]);
        there_and_back(FEETECH_SCS.goal_position, 1003, &[0x03, 0xEB]);
        there_and_back(FEETECH_SCS.velocity, -2, &[0x80, 0x02]);
        there_and_back(FEETECH_SCS.voltage, 50, &[50]);
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
                let current = registers.current.expect("one").in_part(begin, &bytes);
                assert_eq!(current, if has_current { 0x0101 } else { 0 });
            }
        }
    }

    /// Sign and magnitude have two zeros.
    #[test]
    fn negative_zero_is_zero() {
        let homing_offset = FEETECH.homing_offset.expect("one");
        assert_eq!(homing_offset.decode(&[0x00, 0x08]), 0);
        assert_eq!(FEETECH.position.decode(&[0x00, 0x80]), 0);
        assert_eq!(FEETECH_SCS.velocity.decode(&[0x80, 0x00]), 0);
    }
}
