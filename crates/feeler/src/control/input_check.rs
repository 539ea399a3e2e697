//! Whether what arrives for a decision can be decided on.

use super::stop_reason::StopReason;
use super::touch::FingerTouch;
use crate::hand::JointState;
use glam::DVec3;

/// There are as many of `what` as there are fingers.
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

/// What arrived of `finger` fits its `elements` elements, and all of it is a number.
pub(super) fn check_input(
    finger: usize,
    elements: usize,
    touch: &FingerTouch,
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
    // In every step of every finger, so one pass without a branch; what is wrong is found out afterwards. Zero times what is not finite
    // is not a number, and stays so.
    let not_finite = |what| StopReason::NotFinite { finger, what };
    let zeros = forces.iter().fold(DVec3::ZERO, |sum, &f| sum + 0.0 * f);
    if zeros != DVec3::ZERO {
        let no_force = |element| StopReason::NoForce { finger, element };
        let invalid = touch.frame.first_invalid().map(no_force);
        return Err(invalid.unwrap_or_else(|| not_finite("force")));
    }
    if !(joints.position.is_finite() && joints.velocity.is_finite()) {
        return Err(not_finite("joint state"));
    }
    Ok(())
}

/// No element is pressed harder than `limit`, N, where there is one.
pub(super) fn check_load(
    finger: usize,
    touch: &FingerTouch,
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
