//! Validity checks of the controller's input.

use super::stop_reason::StopReason;
use super::touch::TactileReading;
use crate::hand::JointState;
use glam::DVec3;

/// Checks that the number of items (`what`) equals the number of fingers.
pub(super) fn check_count(
    what: &'static str,
    expected: usize,
    actual: usize,
) -> Result<(), StopReason> {
    if actual == expected {
        Ok(())
    } else {
        Err(StopReason::FingerCount {
            what,
            expected,
            actual,
        })
    }
}

/// Checks the input of `finger`: it must have `elements` elements, and `joint_count` joints or an empty joint state,
/// and all numbers must be finite.
pub(super) fn check_input(
    finger: usize,
    elements: usize,
    joint_count: usize,
    touch: &TactileReading,
    joints: &JointState,
) -> Result<(), StopReason> {
    let forces = &touch.frame.forces;
    if forces.len() != elements {
        return Err(StopReason::ElementCount {
            finger,
            expected: elements,
            actual: forces.len(),
        });
    }
    // This runs for every finger in every step, so it is a single pass without branches; the cause is determined
    // afterwards. Zero times a non-finite number is NaN, and so is the sum.
    let not_finite = |what| StopReason::NotFinite { finger, what };
    let zeros = forces.iter().fold(DVec3::ZERO, |sum, &f| sum + 0.0 * f);
    if zeros != DVec3::ZERO {
        let no_force = |element| StopReason::NoForce { finger, element };
        let invalid = touch.frame.first_invalid().map(no_force);
        return Err(invalid.unwrap_or_else(|| not_finite("force")));
    }
    for joints in [&joints.position, &joints.velocity] {
        if joints.len() != joint_count && !joints.is_empty() {
            return Err(StopReason::JointCount {
                finger,
                expected: joint_count,
                actual: joints.len(),
            });
        }
    }
    if !(joints.position.is_finite() && joints.velocity.is_finite()) {
        return Err(not_finite("joint state"));
    }
    Ok(())
}

/// Checks that the compression of every element is at most `limit` (N), if a limit is given.
pub(super) fn check_load(
    finger: usize,
    touch: &TactileReading,
    limit: Option<f64>,
) -> Result<(), StopReason> {
    let Some(limit) = limit else { return Ok(()) };
    let mut forces = touch.frame.forces.iter().enumerate();
    match forces.find(|(_, force)| force.z > limit) {
        Some((element, force)) => Err(StopReason::Overload {
            finger,
            element,
            force: force.z,
            limit,
        }),
        None => Ok(()),
    }
}
