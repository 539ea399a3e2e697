//! Closed-form postures of a finger, and wrapping of angles into the joint limits.
//!
//! The iteration of eq. (10) finds a single posture. The cosine law gives all postures, including any within the
//! limits.

use super::ThreeJoints;
use crate::hand::kinematics_error::{KinematicsError, POSITION_TOLERANCE};
use glam::DVec3;
use std::f64::consts::TAU;

/// Maximum distance of a target from the reachable range for it to count as reachable (m).
const REACH_TOLERANCE: f64 = 0.25 * POSITION_TOLERANCE;

/// Maximum violation of a joint limit that counts as rounding error (rad). The angle is then clamped.
pub(super) const JOINT_TOLERANCE: f64 = 1e-11;

/// Computes the postures, at most four, that bring the fingertip to `target`, with the cosine law (rad).
///
/// An angle that has no effect (for a target on the axis of joint 1 or 2) is taken from `start`.
pub(super) fn postures(
    finger: &ThreeJoints,
    target: DVec3,
    start: DVec3,
) -> Result<[Option<DVec3>; 4], KinematicsError> {
    let [l2, l3, l4] = finger.links;
    let (minimum, maximum) = ((l3 - l4).abs(), l3 + l4);
    let in_base = finger.base_rotation.transpose() * (target - finger.base_position);
    let radius = in_base.truncate().length();
    let distance = |side: f64| libm::hypot(side * radius - l2, in_base.z);
    let posture = |side: f64, elbow: f64| {
        let distance = distance(side);
        if distance < minimum - REACH_TOLERANCE || distance > maximum + REACH_TOLERANCE {
            return None;
        }
        let cos_theta3 = (distance * distance - l3 * l3 - l4 * l4) / (2.0 * l3 * l4);
        let theta3 = elbow * libm::acos(cos_theta3.clamp(-1.0, 1.0));
        let (s3, c3) = libm::sincos(theta3);
        let theta1 = if radius <= REACH_TOLERANCE {
            start.x
        } else {
            libm::atan2(side * in_base.y, side * in_base.x)
        };
        let theta2 = if distance <= REACH_TOLERANCE {
            start.y
        } else {
            libm::atan2(in_base.z, side * radius - l2) - libm::atan2(l4 * s3, l3 + l4 * c3)
        };
        Some(DVec3::new(theta1, theta2, theta3))
    };
    let all = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(s, e)| posture(s, e));
    if all.iter().all(Option::is_none) {
        return Err(KinematicsError::OutOfReach {
            target,
            distance: distance(1.0),
            minimum,
            maximum,
        });
    }
    Ok(all)
}

/// Adds full turns to each angle of `theta`, so that it is within its joint limits if possible, otherwise as close to
/// `start` as possible.
pub(super) fn turn_near(finger: &ThreeJoints, theta: DVec3, start: DVec3) -> DVec3 {
    let (lower, upper) = (finger.lower, finger.upper);
    let near = theta + ((start.clamp(lower, upper) - theta) / TAU).round() * TAU;
    let excess = |angle: f64, joint: usize| (lower[joint] - angle).max(angle - upper[joint]);
    DVec3::from_array([0, 1, 2].map(|joint| {
        let turned = [near[joint], near[joint] - TAU, near[joint] + TAU];
        turned
            .into_iter()
            .find(|&angle| excess(angle, joint) <= JOINT_TOLERANCE)
            .unwrap_or(near[joint])
    }))
}

/// Maximum violation of the joint limits by `theta` (rad); negative if all angles are within their limits.
pub(super) fn limit_excess(finger: &ThreeJoints, theta: DVec3) -> f64 {
    (finger.lower - theta)
        .max(theta - finger.upper)
        .max_element()
}
