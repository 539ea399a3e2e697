//! Whether what a message holds fits the hand and can be true at all.
//!
//! The bounds are far beyond what any hand of this size does: they keep out what no law, task or record can work with.

use super::message::{PROTOCOL, StateMessage, TactileUpdate};
use super::rejection::Rejection;
use feeler_record::wire::Vector3;
use glam::{DQuat, DVec3};

/// Greatest angle of a joint, rad.
const MOST_ANGLE: f64 = 100.0;
/// Greatest angular velocity of a joint, rad/s.
const MOST_JOINT_VELOCITY: f64 = 1000.0;
/// Greatest force on an element or a finger, N.
const MOST_FORCE: f64 = 1e4;
/// Greatest shear rate of an element, N/s.
const MOST_SHEAR_RATE: f64 = 1e8;
/// Greatest reading of an instrument, in its unit.
const MOST_READING: f64 = 1e9;
/// How far the length of a rotation's quaternion may be from 1: rounding is far below.
const UNIT: f64 = 1e-6;

/// Holds a message to the version of this program's.
pub(super) fn check_protocol(protocol: u32) -> Result<(), Rejection> {
    let same = protocol == PROTOCOL;
    same.then_some(()).ok_or(Rejection::Protocol)
}

/// Holds an update to this version, and to a `finger` of so many `elements`.
pub(super) fn check_update(
    finger: usize,
    elements: usize,
    update: &TactileUpdate,
) -> Result<(), Rejection> {
    check_protocol(update.header.protocol)?;
    let mask = elements.div_ceil(8);
    let sizes = usize::try_from(update.finger) == Ok(finger)
        && update.forces.len() == elements
        && update.shear_rate.len() == elements
        && update.slip_mask.len() == mask
        && update.invalid_mask.len() == mask;
    if !sizes {
        return Err(Rejection::Size);
    }
    check(update.forces.iter().map(greatest), MOST_FORCE)?;
    check([update.grasp_force], MOST_FORCE)?;
    check(update.shear_rate.iter().copied(), MOST_SHEAR_RATE)
}

/// Holds a state to this version, and to a hand of so many `fingers`.
pub(super) fn check_state(fingers: usize, state: &StateMessage) -> Result<(), Rejection> {
    check_protocol(state.header.protocol)?;
    let joints = [state.position.len(), state.velocity.len()];
    if joints != [fingers; 2] || state.instruments.len() > 1 {
        return Err(Rejection::Size);
    }
    check(state.position.iter().map(greatest), MOST_ANGLE)?;
    check(state.velocity.iter().map(greatest), MOST_JOINT_VELOCITY)?;
    let readings = state.instruments.iter().flat_map(|i| {
        let others = [
            i.torque,
            i.bridge_voltage,
            i.cap_angle,
            greatest(&i.cap_centre),
            i.cap_torque,
            greatest(&i.object_position),
        ];
        others.into_iter().chain(i.slipped)
    });
    check(readings, MOST_READING)?;
    let orientations = state.instruments.iter().map(|i| i.object_orientation);
    for orientation in orientations.map(DQuat::from) {
        check(orientation.to_array(), 1.0 + UNIT)?;
        if (orientation.length() - 1.0).abs() > UNIT {
            return Err(Rejection::Implausible);
        }
    }
    Ok(())
}

/// Holds commanded joint velocities, rad/s, to a hand of so many `fingers`.
pub(super) fn check_velocities(fingers: usize, velocities: &[Vector3]) -> Result<(), Rejection> {
    if velocities.len() != fingers {
        return Err(Rejection::Size);
    }
    check(velocities.iter().map(greatest), MOST_JOINT_VELOCITY)
}

/// Holds the forces of so many `elements` to what a feeler bears, N.
pub(super) fn check_forces(elements: usize, forces: &[Vector3]) -> Result<(), Rejection> {
    if forces.len() != elements {
        return Err(Rejection::Size);
    }
    check(forces.iter().map(greatest), MOST_FORCE)
}

/// The greatest magnitude of a component; not a number where one is none or infinite.
fn greatest(&vector: &Vector3) -> f64 {
    let vector = DVec3::from(vector);
    match vector.is_finite() {
        true => vector.abs().max_element(),
        false => f64::NAN,
    }
}

/// Holds all `numbers` to a magnitude of at most `most`.
fn check(numbers: impl IntoIterator<Item = f64>, most: f64) -> Result<(), Rejection> {
    for number in numbers {
        if !number.is_finite() {
            return Err(Rejection::NotFinite);
        }
        if number.abs() > most {
            return Err(Rejection::Implausible);
        }
    }
    Ok(())
}
