//! Inverse kinematics of a finger: joint angles for a fingertip position, eq. (10).
//!
//! The iteration of eq. (10) starts from the given joint angles, so that a finger keeps its posture for a nearby
//! target. If the result violates a joint limit or the iteration gets stuck, it restarts from the other postures (left
//! or right of the axis of joint 1, elbow up or down; at most four), which are computed with the cosine law. So a
//! solution is found if there is any within the limits.

use glam::DVec3;

use super::ThreeJoints;
use super::kinematics::Posture;
use super::postures::{JOINT_TOLERANCE, limit_excess, postures, turn_near};
use super::resolved_rate::{damping, solve_damped};
use crate::hand::kinematics_error::{KinematicsError, POSITION_TOLERANCE};

/// Residual at which the iteration stops (m). The rest of the tolerance is reserved for clamping to the joint limits.
const ITERATION_TOLERANCE: f64 = 0.5 * POSITION_TOLERANCE;

/// Maximum change of a joint angle in one step (rad).
const STEP_LIMIT: f64 = 0.5;

/// Maximum number of steps per start. Within one posture, 15 suffice; see the test below.
const STEPS: usize = 40;

/// Maximum number of halvings of a step that does not reduce the distance to the target.
const HALVINGS: usize = 10;

impl ThreeJoints {
    /// Returns joint angles theta1..theta3 (rad, within the joint limits) that bring the fingertip within
    /// [`POSITION_TOLERANCE`] of `target` (in the world `W`, m), eq. (10), from the joint angles `start`.
    pub(in crate::hand) fn inverse_kinematics(
        &self,
        target: DVec3,
        start: DVec3,
    ) -> Result<DVec3, KinematicsError> {
        if !target.is_finite() || !start.is_finite() {
            let start = start.to_array().into();
            return Err(KinematicsError::NotFinite { target, start });
        }
        let start = turn_near(self, start, start);
        let direct = iterate(self, target, start);
        if direct.residual <= ITERATION_TOLERANCE {
            let theta = turn_near(self, direct.theta, start);
            if limit_excess(self, theta) <= JOINT_TOLERANCE {
                return Ok(theta.clamp(self.lower, self.upper));
            }
        }
        restart(self, target, start)
    }
}

/// Solves from the posture within the joint limits that is nearest to `start`.
fn restart(finger: &ThreeJoints, target: DVec3, start: DVec3) -> Result<DVec3, KinematicsError> {
    let (lower, upper) = (finger.lower, finger.upper);
    let start = start.clamp(lower, upper);
    // Order by limit violation first (all postures within the limits are equal), then by distance.
    let excess = |theta: &DVec3| limit_excess(finger, *theta).max(JOINT_TOLERANCE);
    let best = postures(finger, target, start)?
        .into_iter()
        .flatten()
        .map(|theta| turn_near(finger, theta, start))
        .min_by(|a, b| {
            let nearer = a.distance(start).total_cmp(&b.distance(start));
            excess(a).total_cmp(&excess(b)).then(nearer)
        })
        .unwrap_or(start);
    if limit_excess(finger, best) > JOINT_TOLERANCE {
        return Err(KinematicsError::OutsideJointLimits {
            target,
            theta: best.to_array().into(),
            limits: Box::new((lower.to_array().into(), upper.to_array().into())),
        });
    }
    let theta = iterate(finger, target, best).theta.clamp(lower, upper);
    let position = Posture::at(finger, theta).position(finger);
    let residual = position.distance(target);
    if residual > POSITION_TOLERANCE {
        return Err(KinematicsError::NotConverged { target, residual });
    }
    Ok(theta)
}

/// State of the iteration of eq. (10).
struct Iterate {
    theta: DVec3,
    /// Distance of the fingertip from the target (m).
    residual: f64,
}

/// Iterates eq. (10) from `start` with steps `J^-1 (r_d - r)` of at most [`STEP_LIMIT`]. Each step is halved until it
/// reduces the distance to the target.
///
/// Near a singularity the step is damped. The damping never exceeds the residual, so it vanishes even as a singular
/// target is approached.
fn iterate(finger: &ThreeJoints, target: DVec3, start: DVec3) -> Iterate {
    let mut theta = start;
    let mut posture = Posture::at(finger, theta);
    let mut error = target - posture.position(finger);
    for _ in 0..STEPS {
        if error.length() <= ITERATION_TOLERANCE {
            break;
        }
        let jacobian = posture.jacobian(finger);
        let damping = damping(finger, &jacobian).min(error.length());
        let mut step = solve_damped(&jacobian, error, damping);
        step *= (STEP_LIMIT / step.abs().max_element()).min(1.0);
        let mut nearer = false;
        for _ in 0..HALVINGS {
            let next = Posture::at(finger, theta + step);
            let next_error = target - next.position(finger);
            nearer = next_error.length() < error.length();
            if nearer {
                (theta, posture, error) = (theta + step, next, next_error);
                break;
            }
            step *= 0.5;
        }
        if !nearer {
            break;
        }
    }
    Iterate {
        theta,
        residual: error.length(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::finger::FingerConfig;
    use std::f64::consts::TAU;

    /// Returns a finger whose elbow bends one way only, as is common.
    fn geometry() -> ThreeJoints {
        ThreeJoints::new(&FingerConfig {
            base_position: [-0.144, 0.0, 0.06],
            phi1_deg: 0.0,
            phi2_deg: 0.0,
            links: [0.025, 0.05, 0.055],
            joint_lower_deg: [-60.0, -30.0, -120.0],
            joint_upper_deg: [60.0, 90.0, -15.0],
            joint_speed_limit: [3.0; 3],
        })
    }

    /// Returns a grid of 7 x 7 x 7 joint angles that spans the joint limits.
    fn grid(geometry: &ThreeJoints) -> impl Iterator<Item = DVec3> {
        let (lower, span) = (geometry.lower, geometry.upper - geometry.lower);
        (0..343).map(move |i| {
            let share = DVec3::new(f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49)) / 6.0;
            lower + span * share
        })
    }

    #[test]
    fn the_iteration_needs_no_restart_in_one_posture() {
        let geometry = geometry();
        let middle = 0.5 * (geometry.lower + geometry.upper);
        for goal in grid(&geometry) {
            let target = geometry.pose(goal).0;
            let end = iterate(&geometry, target, middle);
            assert!(
                end.residual <= ITERATION_TOLERANCE,
                "{goal}: {:e} m",
                end.residual
            );
        }
    }

    #[test]
    fn every_posture_reaches_the_target() {
        let geometry = geometry();
        for goal in grid(&geometry) {
            let target = geometry.pose(goal).0;
            let mut nearest = f64::INFINITY;
            for theta in postures(&geometry, target, goal)
                .unwrap()
                .into_iter()
                .flatten()
            {
                let miss = geometry.pose(theta).0.distance(target);
                // Rounding of lengths below 0.2 m, and of the cosine law.
                assert!(miss < 1e-15, "{miss:e} m from {target}");
                nearest = nearest.min(turn_near(&geometry, theta, goal).distance(goal));
            }
            // One posture is `goal` itself. theta3 is at least 15 degrees from straight, where the arc cosine loses a
            // factor of 4 in precision.
            assert!(nearest < 1e-13, "{nearest:e} rad");
        }
    }

    #[test]
    fn angles_turn_into_the_limits() {
        let geometry = geometry();
        let inside = DVec3::new(0.5, 0.2, -1.0);
        let turned = turn_near(&geometry, inside + DVec3::new(TAU, -TAU, 3.0 * TAU), inside);
        // Two additions of 3 turns (19 rad) have a rounding error of 4e-15 each.
        assert!(turned.abs_diff_eq(inside, 1e-14), "{turned}");
    }
}
