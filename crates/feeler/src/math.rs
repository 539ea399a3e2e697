//! Directions and rotations with identical results on every processor and operating system.
//!
//! The last digits of the sines and cosines of `std` depend on the system's math library. Code that affects the result
//! of a run uses these functions and the crate `libm` instead, so that the run has the same digest everywhere,
//! including in a browser.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// Unit vector at the angle `angle` (rad) from the x axis.
pub fn direction_at(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}

/// Signed angle from `from` to `to` (rad), between -pi and pi.
pub fn angle_to(from: DVec2, to: DVec2) -> f64 {
    libm::atan2(from.perp_dot(to), from.dot(to))
}

/// Rotation by `angle` (rad) about x.
pub fn rotation_x(angle: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(angle);
    let [y, z] = [DVec3::new(0.0, cos, sin), DVec3::new(0.0, -sin, cos)];
    DMat3::from_cols(DVec3::X, y, z)
}

/// Rotation by `angle` (rad) about y.
pub fn rotation_y(angle: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(angle);
    let [x, z] = [DVec3::new(cos, 0.0, -sin), DVec3::new(sin, 0.0, cos)];
    DMat3::from_cols(x, DVec3::Y, z)
}

/// Rotation by `angle` (rad) about z.
pub fn rotation_z(angle: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(angle);
    let [x, y] = [DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0)];
    DMat3::from_cols(x, y, DVec3::Z)
}

/// Quaternion of the rotation by `angle` (rad) about z.
pub fn quaternion_z(angle: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle);
    DQuat::from_xyzw(0.0, 0.0, sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both libraries are correct to one unit in the last place.
    const TOLERANCE: f64 = 2.0 * f64::EPSILON;

    #[test]
    fn rotations_equal_those_of_glam() {
        for step in -1000..1000 {
            let angle = 0.01 * f64::from(step);
            let pairs = [
                (rotation_x(angle), DMat3::from_rotation_x(angle)),
                (rotation_y(angle), DMat3::from_rotation_y(angle)),
                (rotation_z(angle), DMat3::from_rotation_z(angle)),
            ];
            for (own, glam) in pairs {
                assert!(own.abs_diff_eq(glam, TOLERANCE), "{angle}: {own} {glam}");
            }
            assert!(direction_at(angle).abs_diff_eq(DVec2::from_angle(angle), TOLERANCE));
            let turned = angle_to(DVec2::new(0.3, 0.4), direction_at(angle));
            let glam = DVec2::new(0.3, 0.4).angle_to(direction_at(angle));
            // The arc cosine of glam loses half of the digits near 0 and pi.
            assert!((turned - glam).abs() <= 1e-7, "{angle}: {turned} {glam}");
            let (own, glam) = (quaternion_z(angle), DQuat::from_rotation_z(angle));
            assert!(own.abs_diff_eq(glam, TOLERANCE), "{angle}: {own} {glam}");
        }
    }
}
