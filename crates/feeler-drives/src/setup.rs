//! How servos are set before they may move: what is otherwise is changed, and nothing else.

use crate::bus::{Bus, BusError};
use crate::config::{DrivesConfig, JointDriveConfig};
use crate::error::{DriveError, JointName};
use crate::health::Health;
use crate::packet::Protocol;
use crate::registers::{COUNTS_PER_TURN, Model, Register, Registers, VELOCITY_MODE};

/// A value of a servo that is not as it has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// The joint that the servo moves.
    pub joint: JointName,
    /// The value's name, as in the vendor's table.
    pub name: &'static str,
    /// Where it is.
    pub register: Register,
    /// What it is.
    pub from: i64,
    /// What it has to be.
    pub to: i64,
}

/// The joints of `config` with their names.
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

/// An error of the bus, laid to the servo of `joint` unless the port fails.
pub(crate) fn blame(joint: JointName) -> impl Fn(BusError) -> DriveError {
    move |source| match source {
        BusError::Port(_) | BusError::Open { .. } | BusError::Echo => DriveError::Bus(source),
        source => DriveError::Servo { joint, source },
    }
}

/// The model of the servo of `joint`.
///
/// # Errors
/// When it does not answer, or is another than `drive` says.
pub fn check_model(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
) -> Result<&'static Model, DriveError> {
    let registers = Registers::of(bus.protocol());
    let actual = bus.read(joint.id, registers.model).map_err(blame(joint))?;
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

/// Requires the firmware of the servo of `joint`, a `model`, to know fast sync reads.
///
/// # Errors
/// When it does not answer, or its firmware is too old.
pub fn check_fast_sync_read(
    bus: &mut Bus,
    joint: JointName,
    model: &Model,
) -> Result<(), DriveError> {
    let register = Registers::of(bus.protocol()).firmware;
    // Where there is none, the file is refused before it comes to this.
    let (Some(register), Some(expected)) = (register, model.fast_sync_firmware) else {
        return Ok(());
    };
    let actual = bus.read(joint.id, register).map_err(blame(joint))?;
    match actual >= expected {
        true => Ok(()),
        false => Err(DriveError::Firmware {
            joint,
            expected,
            actual,
        }),
    }
}

/// What has to be changed in the memory of the servo of `joint`, which keeps that without power. Writes nothing.
///
/// # Errors
/// When it does not answer as it should, or is another than `drive` says.
pub fn changes(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
) -> Result<Vec<Change>, DriveError> {
    let model = check_model(bus, joint, drive)?;
    let registers = Registers::of(bus.protocol());
    let mut wanted = vec![
        ("Return Delay Time", registers.return_delay, 0),
        ("Operating Mode", registers.mode, VELOCITY_MODE),
    ];
    if let Some(limit) = drive.current_limit {
        let counts = (limit / model.current_unit).round() as i64;
        wanted.push(("Current Limit", registers.current_limit, counts));
    }
    let mut changes = Vec::new();
    for (name, register, to) in wanted {
        let from = bus.read(joint.id, register).map_err(blame(joint))?;
        if from != to {
            changes.push(Change {
                joint,
                name,
                register,
                from,
                to,
            });
        }
    }
    Ok(changes)
}

/// Makes these changes of one servo, whose torque is off.
///
/// # Errors
/// When it does not take or keep one.
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
        set(bus, change.joint, (change.name, change.register), change.to)?;
    }
    if let Some(lock) = lock {
        bus.write(id, lock, 1).map_err(blame(first.joint))?;
    }
    Ok(())
}

/// Writes a value, and reads whether it is there.
pub(crate) fn set(
    bus: &mut Bus,
    joint: JointName,
    (name, register): (&'static str, Register),
    expected: i64,
) -> Result<(), DriveError> {
    bus.write(joint.id, register, expected)
        .map_err(blame(joint))?;
    let actual = bus.read(joint.id, register).map_err(blame(joint))?;
    match actual == expected {
        true => Ok(()),
        false => Err(DriveError::NotSet {
            joint,
            name,
            expected,
            actual,
        }),
    }
}

/// What the servo of `joint` says of itself.
///
/// # Errors
/// When it does not answer as it should.
pub fn read_health(bus: &mut Bus, joint: JointName) -> Result<Health, DriveError> {
    let registers = Registers::of(bus.protocol());
    let mut read = |register| bus.read(joint.id, register).map_err(blame(joint));
    Ok(Health {
        fault: read(registers.fault)? as u8,
        temperature: read(registers.temperature)? as f64,
        voltage: read(registers.voltage)? as f64 / 10.0,
    })
}

/// The position of the servo of `joint`, counts.
///
/// # Errors
/// When it does not answer as it should.
pub fn read_counts(bus: &mut Bus, joint: JointName) -> Result<i64, DriveError> {
    let register = Registers::of(bus.protocol()).position;
    bus.read(joint.id, register).map_err(blame(joint))
}

/// The angle, rad, of a `joint` that has to be between these limits, rad.
///
/// # Errors
/// When its servo does not answer as it should, or it is beyond its limits.
pub fn read_angle(
    bus: &mut Bus,
    joint: JointName,
    drive: &JointDriveConfig,
    (lower, upper): (f64, f64),
) -> Result<f64, DriveError> {
    let counts = read_counts(bus, joint)? as f64;
    let angle = drive.angle(match bus.protocol() {
        Protocol::Dynamixel => counts,
        Protocol::Feetech => {
            // It starts again with every turn.
            let near = drive.counts((lower + upper) / 2.0);
            let half = COUNTS_PER_TURN / 2.0;
            near + (counts - near + half).rem_euclid(COUNTS_PER_TURN) - half
        }
    });
    match (lower..=upper).contains(&angle) {
        true => Ok(angle),
        false => Err(DriveError::BeyondLimits {
            joint,
            angle,
            lower,
            upper,
        }),
    }
}
