//! Resolved motion rate control, eq. (1), damped near singularities.
//!
//! Away from singularities this is eq. (1), `theta_dot = J^-1 r_dot`. If the smallest singular value sigma of `J` is
//! below a threshold epsilon, it is the damped least-squares solution
//!
//! ```text
//! theta_dot = J^T (J J^T + lambda^2 I)^-1 r_dot,    lambda^2 = epsilon^2 - sigma^2
//! ```
//!
//! lambda grows from 0 at `sigma = epsilon` to epsilon at the singularity, so the joint velocity is continuous. A
//! direction with singular value `s >= sigma` is amplified by `s / (s^2 + epsilon^2 - sigma^2)`, which is at most `1
//! / epsilon`. So `|theta_dot| <= |r_dot| / epsilon` everywhere.

use glam::{DMat3, DVec3};

use super::ThreeJoints;

/// Damping threshold epsilon as a fraction of the shorter of l3 and l4. With equal links, damping starts within about
/// 13 degrees of a straight finger, or if the tip is within a tenth of a link length of the axis of joint 1.
const THRESHOLD_SHARE: f64 = 0.1;

impl ThreeJoints {
    /// Returns the joint velocity (rad/s) that moves the fingertip at `fingertip_velocity` (in the world `W`, m/s) at
    /// joint angles `theta` (rad), eq. (1), and the damping lambda (m/rad).
    pub(in crate::hand) fn resolved_rate(
        &self,
        theta: DVec3,
        fingertip_velocity: DVec3,
    ) -> (DVec3, f64) {
        let jacobian = self.jacobian(theta);
        let damping = damping(self, &jacobian);
        // Solved for a velocity of magnitude 1, so that no intermediate product can overflow.
        let magnitude = fingertip_velocity
            .abs()
            .max_element()
            .max(f64::MIN_POSITIVE);
        let unit_solution = solve_damped(&jacobian, fingertip_velocity / magnitude, damping);
        let velocity = (unit_solution * magnitude).map(|v| v.clamp(f64::MIN, f64::MAX));
        (velocity, damping)
    }

    /// Threshold epsilon (m/rad): damping starts when the smallest singular value of the Jacobian falls below it.
    pub(in crate::hand) fn damping_threshold(&self) -> f64 {
        let [_, l3, l4] = self.links;
        THRESHOLD_SHARE * l3.min(l4)
    }
}

/// Damping lambda for `jacobian` (m/rad).
pub(super) fn damping(finger: &ThreeJoints, jacobian: &DMat3) -> f64 {
    let threshold = finger.damping_threshold();
    let sigma = smallest_singular_value(jacobian);
    (threshold * threshold - sigma * sigma).max(0.0).sqrt()
}

/// Damped least-squares solution x of `jacobian x = b`; the exact solution if `damping` is 0.
pub(super) fn solve_damped(jacobian: &DMat3, b: DVec3, damping: f64) -> DVec3 {
    if damping == 0.0 {
        return jacobian.inverse() * b;
    }
    let transpose = jacobian.transpose();
    let gram = *jacobian * transpose + DMat3::from_diagonal(DVec3::splat(damping * damping));
    transpose * (gram.inverse() * b)
}

/// Smallest singular value of a finger's Jacobian (m/rad).
///
/// Closed form: the first column is orthogonal to the others, so its length is one singular value. The other two are
/// the singular values of the remaining 3 x 2 matrix. Their product is the area that its columns span, which, unlike
/// the difference of their squares, is accurate near 0.
fn smallest_singular_value(jacobian: &DMat3) -> f64 {
    let (u, w) = (jacobian.y_axis, jacobian.z_axis);
    let (uu, ww, uw) = (u.length_squared(), w.length_squared(), u.dot(w));
    // The squares are far from overflow, so the slower `hypot` is not needed.
    let spread = ((uu - ww) * (uu - ww) + 4.0 * uw * uw).sqrt();
    let largest = (0.5 * (uu + ww + spread)).sqrt();
    let area = u.cross(w).length();
    jacobian.x_axis.length().min(area / largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::finger::FingerConfig;

    fn geometry() -> ThreeJoints {
        ThreeJoints::new(&FingerConfig {
            base_position: [-0.144, 0.0, 0.06],
            phi1_deg: 30.0,
            phi2_deg: -20.0,
            links: [0.025, 0.05, 0.055],
            joint_lower_deg: [-180.0; 3],
            joint_upper_deg: [180.0; 3],
            joint_speed_limit: [3.0; 3],
        })
    }

    #[test]
    fn smallest_singular_value_is_that_of_the_svd() {
        let geometry = geometry();
        for i in 0..200 {
            let theta = DVec3::new(0.1, 0.07, 0.031) * f64::from(i) - 3.0;
            let j = geometry.jacobian(theta);
            let svd = nalgebra::Matrix3::from_column_slice(&j.to_cols_array()).svd(false, false);
            // Both lose a few units in the last place of the largest singular value, 0.1 m/rad.
            let difference = smallest_singular_value(&j) - svd.singular_values.min();
            assert!(difference.abs() < 1e-15, "{theta}: {difference:e}");
        }
    }

    #[test]
    fn damping_grows_from_zero_to_the_threshold() {
        let geometry = geometry();
        let at = |theta3| {
            let theta = DVec3::new(0.3, 0.4, theta3);
            geometry.resolved_rate(theta, DVec3::X).1
        };
        assert_eq!(at(1.0), 0.0);
        assert_eq!(at(-0.3), 0.0);
        assert!(at(0.1) > 0.0 && at(0.1) < at(0.05));
        assert_eq!(at(0.0), geometry.damping_threshold());
    }

    #[test]
    fn joint_velocity_is_continuous_where_damping_starts() {
        let geometry = geometry();
        let at = |theta3| geometry.resolved_rate(DVec3::new(0.3, 0.4, theta3), DVec3::ONE);
        let (mut undamped, mut damped) = (1.0, 0.0);
        for _ in 0..60 {
            let middle = 0.5 * (undamped + damped);
            if at(middle).1 == 0.0 {
                undamped = middle;
            } else {
                damped = middle;
            }
        }
        let jump = (at(undamped).0 - at(damped).0).length();
        // The two angles are adjacent floating-point numbers. The damped and undamped solver differ by rounding:
        // 1e-16 times the squared condition number (about 500) times the joint velocity (about 200 rad/s).
        assert!(jump < 1e-9, "{jump:e}");
    }

    #[test]
    fn nan_is_not_hidden() {
        let velocity = DVec3::new(0.0, f64::NAN, 0.0);
        let (result, _) = geometry().resolved_rate(DVec3::new(0.3, 0.4, 0.5), velocity);
        assert!(result.is_nan());
    }
}
