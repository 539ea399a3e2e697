//! Configuration of servos before they are allowed to move. Only writes values that differ.

use crate::bus::{Bus, BusError};
use crate::config::{DrivesConfig, JointDriveConfig};
use crate::error::{DriveError, JointName};
use crate::health::Health;
use crate::packet::Protocol;
use crate::registers::{DriveMode, Model, Register, Registers};
use crate::servo::{ServoJoint, ServoJoints};
use feeler::hand::FingerGeometry;

/// Returns `true` if the torque of the servo of `joint` is on.
///
/// # Errors
/// If the servo does not answer.
pub fn is_torque_on(bus: &mut Bus, joint: JointName) -> Result<bool, DriveError> {
    let torque = Registers::of(bus.protocol()).torque;
    Ok(read(bus, joint, torque)? != 0)
}

/// A value that must be changed in a servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// Joint of the servo.
    pub joint: JointName,
    /// Register to be changed.
    pub register: Register,
    /// Current value.
    pub from: i64,
    /// Required value.
    pub to: i64,
}

/// Joints of `config` with their names.
pub fn named_joints(config: &DrivesConfig) -> impl Iterator<Item = (JointName, &JointDriveConfig)> {
    let fingers = config.finger.iter().enumerate();
    fingers.flat_map(|(finger, drives)| {
        let joints = drives.joint.iter().enumerate();
        joints.map(move |(joint, drive)| {
            let id = drive.id;
            (JointName { finger, joint, id }, drive)
        })
    })
}

/// Servos of `config`, each with the first joint that it moves.
pub fn named_servos(config: &DrivesConfig) -> impl Iterator<Item = (JointName, &JointDriveConfig)> {
    named_joints(config).filter(|(_, drive)| !drive.shared)
}

/// Joints of `config` that the servo with this `id` moves.
pub fn joints_of_servo(
    config: &DrivesConfig,
    id: u8,
) -> impl Iterator<Item = (JointName, &JointDriveConfig)> {
    named_joints(config).filter(move |(joint, _)| joint.id == id)
}

/// Returns the range of `joint` (rad or m) within which all joints that its servo moves are within their limits.
///
/// # Errors
/// If the hand with these `fingers` has no such joint, or if no position of the servo suits all joints.
pub fn servo_range(
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
    joint: JointName,
) -> Result<(f64, f64), DriveError> {
    Ok(ServoJoints::of(config, fingers, joint)?.range_of(joint))
}

/// Returns the maximum speed at which `joint`, moved by `drive`, may be jogged (rad/s or m/s): no joint of its servo
/// exceeds its own [`jog_speed`](JointDriveConfig::jog_speed).
///
/// # Errors
/// See [`servo_range`].
pub fn jog_speed(
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
    (joint, drive): (JointName, &JointDriveConfig),
) -> Result<f64, DriveError> {
    Ok(ServoJoints::of(config, fingers, joint)?.jog_speed(drive))
}

/// Attributes an error of the bus to the servo of `joint`, unless the port failed.
pub(crate) fn blame(joint: JointName) -> impl Fn(BusError) -> DriveError {
    move |source| match source {
        BusError::Port(_) | BusError::Open { .. } | BusError::Echo => DriveError::Bus(source),
        source => DriveError::Servo { joint, source },
    }
}

/// Reads `register` of the servo of `joint`.
pub(crate) fn read(bus: &mut Bus, joint: JointName, register: Register) -> Result<i64, DriveError> {
    bus.read(joint.id, register).map_err(blame(joint))
}

/// Checks the model of the servo of `joint` and returns it.
///
/// # Errors
/// If the servo does not answer, or if its model differs from `drive`.
pub fn check_model(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
) -> Result<&'static Model, DriveError> {
    let registers = Registers::of(bus.protocol());
    let actual = read(bus, joint, registers.model)?;
    match drive.known_model() {
        Some(model) if model.number == actual => Ok(model),
        other => Err(DriveError::Model {
            joint,
            expected: other.map_or(-1, |model| model.number),
            name: other.map_or("known model", |model| model.name),
            actual,
        }),
    }
}

/// Checks that the firmware of the servo of `joint`, a `model`, supports fast sync reads.
///
/// # Errors
/// If the servo does not answer, or if its firmware is too old.
pub fn check_fast_sync_read(
    bus: &mut Bus,
    joint: JointName,
    model: &Model,
) -> Result<(), DriveError> {
    let register = Registers::of(bus.protocol()).firmware;
    // Configurations without support are rejected earlier.
    let (Some(register), Some(expected)) = (register, model.fast_sync_firmware) else {
        return Ok(());
    };
    let actual = read(bus, joint, register)?;
    match actual >= expected {
        true => Ok(()),
        false => Err(DriveError::Firmware {
            joint,
            expected,
            actual,
        }),
    }
}

/// Returns the required changes to the EEPROM of the servo of `joint`, for the `range` of this joint (rad or m); see
/// [`servo_range`]. Writes nothing.
///
/// # Errors
/// If the servo does not answer correctly, if its model differs from `drive`, or if it cannot reach the joint's range.
pub fn changes(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
    range: (f64, f64),
) -> Result<Vec<Change>, DriveError> {
    let model = check_model(bus, joint, drive)?;
    let protocol = bus.protocol();
    let registers = Registers::of(protocol);
    let mut wanted = vec![(registers.return_delay, 0)];
    if let Some(mode) = registers.mode {
        wanted.push((mode, drive.mode().number(protocol)));
    }
    if protocol != Protocol::Dynamixel && drive.mode() != DriveMode::Velocity {
        // The servo itself keeps a corrupted goal, which its weak checksum may not detect, within the joint's range.
        let limits = position_limits(model, joint, drive, range)?;
        wanted.extend(registers.position_limits.into_iter().zip(limits));
    }
    if let (Some(limit), Some(register)) = (drive.current_limit, registers.current_limit) {
        let counts = (limit / model.current_unit).round() as i64;
        wanted.push((register, counts));
    }
    let mut changes = Vec::new();
    for (register, to) in wanted {
        let from = read(bus, joint, register)?;
        if from != to {
            changes.push(Change {
                joint,
                register,
                from,
                to,
            });
        }
    }
    Ok(changes)
}

/// Returns the `range` of the servo of `joint` in counts, if the servo of `model` can hold every position in it.
fn position_limits(
    model: &Model,
    joint: JointName,
    drive: &JointDriveConfig,
    range: (f64, f64),
) -> Result<[i64; 2], DriveError> {
    let counts = |end: f64| model.to_counts(drive.horn(end)).round() as i64;
    let (begin, end) = (counts(range.0), counts(range.1));
    let (lower, upper) = (begin.min(end), begin.max(end));
    let turn = model.counts;
    let turns = match model.protocol {
        Protocol::FeetechScs => 0,
        _ => lower.div_euclid(turn),
    };
    let limits = [lower, upper].map(|end| end - turns * turn);
    match limits.iter().all(|end| (0..turn).contains(end)) {
        true => Ok(limits),
        false if model.protocol == Protocol::FeetechScs => Err(DriveError::OutOfReach {
            joint,
            lower,
            upper,
            most: turn - 1,
        }),
        false => Err(DriveError::Wraps {
            joint,
            lower,
            upper,
        }),
    }
}

/// Applies changes to one servo, whose torque must be off.
///
/// # Errors
/// If the servo does not accept or store a value.
pub(crate) fn apply(bus: &mut Bus, changes: &[Change]) -> Result<(), DriveError> {
    let Some(first) = changes.first() else {
        return Ok(());
    };
    let lock = Registers::of(bus.protocol()).lock;
    let id = first.joint.id;
    if let Some(lock) = lock {
        bus.write(id, lock, 0).map_err(blame(first.joint))?;
    }
    for change in changes {
        set(bus, change.joint, change.register, change.to)?;
    }
    if let Some(lock) = lock {
        bus.write(id, lock, 1).map_err(blame(first.joint))?;
    }
    Ok(())
}

/// Writes a value and verifies it.
pub(crate) fn set(
    bus: &mut Bus,
    joint: JointName,
    register: Register,
    expected: i64,
) -> Result<(), DriveError> {
    bus.write(joint.id, register, expected)
        .map_err(blame(joint))?;
    let actual = read(bus, joint, register)?;
    match actual == expected {
        true => Ok(()),
        false => Err(DriveError::NotSet {
            joint,
            name: register.name,
            expected,
            actual,
        }),
    }
}

/// Reads the health of the servo of `joint`.
///
/// # Errors
/// If the servo does not answer correctly.
pub fn read_health(bus: &mut Bus, joint: JointName) -> Result<Health, DriveError> {
    let registers = Registers::of(bus.protocol());
    let mut read = |register| read(bus, joint, register);
    Ok(Health::of(
        read(registers.fault)?,
        read(registers.temperature)?,
        read(registers.voltage)?,
    ))
}

/// Reads the position of the servo of `joint`, counts.
///
/// # Errors
/// If the servo does not answer correctly.
pub fn read_counts(bus: &mut Bus, joint: JointName) -> Result<i64, DriveError> {
    let register = Registers::of(bus.protocol()).position;
    read(bus, joint, register)
}

/// Checks that the velocity limit of the servo of `joint` is at least its velocity at the speed limit of its joints.
/// `model` is that of the servo; see [`check_model`].
///
/// # Errors
/// If the servo does not answer, or is limited to a lower velocity.
pub fn check_velocity_limit(
    bus: &mut Bus,
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
    (joint, model): (JointName, &Model),
) -> Result<(), DriveError> {
    let joints = ServoJoints::of(config, fingers, joint)?;
    let expected = joints.limits.speed * joints.first.drive.transmission();
    let limit = match Registers::of(model.protocol).velocity_limit {
        Some(limit) => read(bus, joint, limit)?,
        None => model.velocity_limit,
    };
    let actual = limit as f64 * model.velocity_unit;
    match actual >= expected {
        true => Ok(()),
        false => Err(DriveError::VelocityLimit {
            joint,
            expected,
            actual,
        }),
    }
}

/// Reads the positions of all joints that the servo of `joint` moves (rad or m), in the order of [`joints_of_servo`], and
/// checks that they are within their limits.
///
/// # Errors
/// If the servo does not answer correctly, if it is of another model, or if one of its joints is beyond its limits.
pub fn read_angles(
    bus: &mut Bus,
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
    joint: JointName,
) -> Result<Vec<f64>, DriveError> {
    let mut joints = ServoJoints::of(config, fingers, joint)?;
    let model = check_model(bus, joint, &joints.first.drive)?;
    let counts = joints.unwrap_position(model, read_counts(bus, joint)?, None);
    joints.update(model.to_angle(counts as f64), 0.0);
    let angle = |joint: &ServoJoint| joint.check(0.0, 1.0).map(|()| joint.angle);
    joints.iter().map(angle).collect()
}
