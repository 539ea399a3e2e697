//! Size and plausibility checks of message contents.
//!
//! The bounds are far beyond the range of any hand of this size. They reject values that laws, tasks and recordings
//! cannot handle.

use super::joints::JointCounts;
use super::message::{PROTOCOL, StateMessage, TactileUpdate};
use super::rejection::Rejection;
use feeler_record::wire::Vector3;
use glam::{DQuat, DVec3};

/// Maximum magnitude of a joint position (rad or m).
const MAX_ANGLE: f64 = 100.0;
/// Maximum magnitude of a joint velocity (rad/s or m/s).
const MAX_JOINT_VELOCITY: f64 = 1000.0;
/// Maximum effort of a motor on its joint, and of its uncertainty (N m or N).
const MAX_EFFORT: f64 = 1e6;
/// Maximum force on an element or a finger (N).
const MAX_FORCE: f64 = 1e4;
/// Maximum shear rate of an element (N/s).
const MAX_SHEAR_RATE: f64 = 1e8;
/// Maximum magnitude of an instrument reading, in its unit.
const MAX_READING: f64 = 1e9;
/// Tolerance of the norm of a unit quaternion; far above rounding errors.
const UNIT: f64 = 1e-6;

/// Checks the protocol version of a message.
pub(crate) fn check_protocol(protocol: u32) -> Result<(), Rejection> {
    let same = protocol == PROTOCOL;
    same.then_some(()).ok_or(Rejection::Protocol)
}

/// Checks version, sizes and values of an update of `finger`, which has the given number of elements.
pub(crate) fn check_update(
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
    check(update.forces.iter().map(greatest), MAX_FORCE)?;
    check([update.grasp_force], MAX_FORCE)?;
    check(update.shear_rate.iter().copied(), MAX_SHEAR_RATE)
}

/// Checks version, sizes and values of a state of a hand with the given number of fingers and joints.
pub(crate) fn check_state(
    fingers: usize,
    joints: &JointCounts,
    state: &StateMessage,
) -> Result<(), Rejection> {
    check_protocol(state.header.protocol)?;
    joints.check(fingers, &state.position)?;
    joints.check(fingers, &state.velocity)?;
    if state.instruments.len() > 1 {
        return Err(Rejection::Size);
    }
    check(state.position.iter().map(greatest), MAX_ANGLE)?;
    check(state.velocity.iter().map(greatest), MAX_JOINT_VELOCITY)?;
    if !(state.effort.is_empty() && state.effort_uncertainty.is_empty()) {
        joints.check(fingers, &state.effort)?;
        joints.check(fingers, &state.effort_uncertainty)?;
        let efforts = joints.of_message(&state.effort).flatten();
        check(efforts.filter(|effort| !effort.is_nan()), MAX_EFFORT)?;
        let uncertainties = &state.effort_uncertainty;
        check(uncertainties.iter().map(greatest), MAX_EFFORT)?;
    }
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
    check(readings, MAX_READING)?;
    let orientations = state.instruments.iter().map(|i| i.object_orientation);
    for orientation in orientations.map(DQuat::from) {
        check(orientation.to_array(), 1.0 + UNIT)?;
        if (orientation.length() - 1.0).abs() > UNIT {
            return Err(Rejection::Implausible);
        }
    }
    Ok(())
}

/// Checks number and values of commanded joint velocities (rad/s or m/s).
pub(crate) fn check_velocities(
    fingers: usize,
    joints: &JointCounts,
    velocities: &[Vector3],
) -> Result<(), Rejection> {
    joints.check(fingers, velocities)?;
    check(velocities.iter().map(greatest), MAX_JOINT_VELOCITY)
}

/// Checks number and values of element forces (N).
pub(crate) fn check_forces(elements: usize, forces: &[Vector3]) -> Result<(), Rejection> {
    if forces.len() != elements {
        return Err(Rejection::Size);
    }
    check(forces.iter().map(greatest), MAX_FORCE)
}

/// Returns the largest absolute component, or NaN if a component is not finite.
fn greatest(&vector: &Vector3) -> f64 {
    let vector = DVec3::from(vector);
    match vector.is_finite() {
        true => vector.abs().max_element(),
        false => f64::NAN,
    }
}

/// Checks that all `numbers` are finite and of magnitude at most `most`.
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
