//! Control tables of each protocol.

use super::{ByteOrder, Register, Registers, Sign};

const fn register(name: &'static str, address: u16, length: usize, sign: Sign) -> Register {
    Register {
        name,
        address,
        length,
        sign,
        order: ByteOrder::Little,
    }
}

/// A register of two bytes, most significant byte first.
const fn big_endian(name: &'static str, address: u16, sign: Sign) -> Register {
    Register {
        order: ByteOrder::Big,
        ..register(name, address, 2, sign)
    }
}

pub(super) const DYNAMIXEL: Registers = Registers {
    model: register("Model Number", 0, 2, Sign::Unsigned),
    firmware: Some(register("Firmware Version", 6, 1, Sign::Unsigned)),
    return_delay: register("Return Delay Time", 9, 1, Sign::Unsigned),
    mode: Some(register("Operating Mode", 11, 1, Sign::Unsigned)),
    homing_offset: Some(register("Homing Offset", 20, 4, Sign::Two)),
    position_limits: [
        register("Min Position Limit", 52, 4, Sign::Unsigned),
        register("Max Position Limit", 48, 4, Sign::Unsigned),
    ],
    shutdown: Some(register("Shutdown", 63, 1, Sign::Unsigned)),
    lock: None,
    current_limit: Some(register("Current Limit", 38, 2, Sign::Unsigned)),
    velocity_limit: Some(register("Velocity Limit", 44, 4, Sign::Unsigned)),
    torque: register("Torque Enable", 64, 1, Sign::Unsigned),
    fault: register("Hardware Error Status", 70, 1, Sign::Unsigned),
    watchdog: Some(register("Bus Watchdog", 98, 1, Sign::Two)),
    goal_velocity: register("Goal Velocity", 104, 4, Sign::Two),
    goal_position: register("Goal Position", 116, 4, Sign::Two),
    goal_current: Some(register("Goal Current", 102, 2, Sign::Two)),
    output_limit: None,
    profile_acceleration: Some(register("Profile Acceleration", 108, 4, Sign::Unsigned)),
    profile_velocity: register("Profile Velocity", 112, 4, Sign::Unsigned),
    current: Some(register("Present Current", 126, 2, Sign::Two)),
    velocity: register("Present Velocity", 128, 4, Sign::Two),
    position: register("Present Position", 132, 4, Sign::Two),
    voltage: register("Present Input Voltage", 144, 2, Sign::Unsigned),
    temperature: register("Present Temperature", 146, 1, Sign::Unsigned),
    motion: (128, 8),
    motion_and_current: (126, 10),
    motion_has_health: false,
};

pub(super) const FEETECH: Registers = Registers {
    model: register("Model Number", 3, 2, Sign::Unsigned),
    firmware: None,
    return_delay: register("Return Delay Time", 7, 1, Sign::Unsigned),
    mode: Some(register("Operating Mode", 33, 1, Sign::Unsigned)),
    homing_offset: Some(register("Homing Offset", 31, 2, Sign::Bit(11))),
    position_limits: [
        register("Min Position Limit", 9, 2, Sign::Unsigned),
        register("Max Position Limit", 11, 2, Sign::Unsigned),
    ],
    shutdown: None,
    lock: Some(register("Lock", 55, 1, Sign::Unsigned)),
    current_limit: Some(register("Protection Current", 28, 2, Sign::Unsigned)),
    velocity_limit: None,
    torque: register("Torque Enable", 40, 1, Sign::Unsigned),
    fault: register("Status", 65, 1, Sign::Unsigned),
    watchdog: None,
    goal_velocity: register("Goal Velocity", 46, 2, Sign::Bit(15)),
    goal_position: register("Goal Position", 42, 2, Sign::Bit(15)),
    goal_current: None,
    output_limit: Some(register("Torque Limit", 48, 2, Sign::Unsigned)),
    profile_acceleration: Some(register("Acceleration", 41, 1, Sign::Unsigned)),
    profile_velocity: register("Goal Velocity", 46, 2, Sign::Bit(15)),
    current: Some(register("Present Current", 69, 2, Sign::Bit(15))),
    velocity: register("Present Velocity", 58, 2, Sign::Bit(15)),
    position: register("Present Position", 56, 2, Sign::Bit(15)),
    voltage: register("Present Voltage", 62, 1, Sign::Unsigned),
    temperature: register("Present Temperature", 63, 1, Sign::Unsigned),
    motion: (56, 10),
    motion_and_current: (56, 15),
    motion_has_health: true,
};

/// Positions are those of a potentiometer: there is no turn to count and no offset. Position control is the only mode
/// that controls the motion; without limits, the servo is a motor without control.
pub(super) const FEETECH_SCS: Registers = Registers {
    model: big_endian("Model Number", 3, Sign::Unsigned),
    firmware: None,
    return_delay: register("Return Delay Time", 7, 1, Sign::Unsigned),
    mode: None,
    homing_offset: None,
    position_limits: [
        big_endian("Min Position Limit", 9, Sign::Unsigned),
        big_endian("Max Position Limit", 11, Sign::Unsigned),
    ],
    shutdown: None,
    lock: Some(register("Lock", 48, 1, Sign::Unsigned)),
    current_limit: None,
    velocity_limit: None,
    torque: register("Torque Enable", 40, 1, Sign::Unsigned),
    fault: register("Status", 65, 1, Sign::Unsigned),
    watchdog: None,
    goal_velocity: big_endian("Goal Velocity", 46, Sign::Unsigned),
    goal_position: big_endian("Goal Position", 42, Sign::Unsigned),
    goal_current: None,
    output_limit: None,
    profile_acceleration: None,
    profile_velocity: big_endian("Goal Velocity", 46, Sign::Unsigned),
    current: None,
    velocity: big_endian("Present Velocity", 58, Sign::Bit(15)),
    position: big_endian("Present Position", 56, Sign::Unsigned),
    voltage: register("Present Voltage", 62, 1, Sign::Unsigned),
    temperature: register("Present Temperature", 63, 1, Sign::Unsigned),
    motion: (56, 10),
    motion_and_current: (56, 10),
    motion_has_health: true,
};
