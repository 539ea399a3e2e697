//! Forward kinematics and Jacobian of a finger, eqs. (2) and (3).

use glam::{DMat3, DVec3};

use super::ThreeJoints;
use crate::hand::sin_cos::sin_cos;

/// Intermediate results at one set of joint angles, shared by the pose and the Jacobian.
pub(super) struct Posture {
    /// Column 1 of the matrix a of eq. (3): horizontal direction of the finger's plane, in `W`.
    radial: DVec3,
    /// Column 3 of a: axis of joint 1 and second direction of the finger's plane, in `W`.
    axial: DVec3,
    /// Distance of the fingertip from the axis of joint 1 along `radial`, `l2 + l3 c2 + l4 c23` (m).
    radius: f64,
    /// Distance of the fingertip from the base along `axial`, `l3 s2 + l4 s23` (m).
    height: f64,
    sin_theta3: f64,
    cos_theta3: f64,
    /// Rotation R of eq. (3), from `T` to `W`.
    pub(super) rotation: DMat3,
}

impl Posture {
    #[inline(always)]
    pub(super) fn at(finger: &ThreeJoints, theta: DVec3) -> Self {
        let (sines, cosines) = sin_cos(theta);
        let ([s1, s2, s3], [c1, c2, c3]) = (sines.to_array(), cosines.to_array());
        // The sum formulas avoid an overflow of theta2 + theta3.
        let (s23, c23) = (s2 * c3 + c2 * s3, c2 * c3 - s2 * s3);
        let [l2, l3, l4] = finger.links;

        // The columns of a = Ry(phi1) Rx(phi2) Rz(theta1).
        let base = finger.base_rotation;
        let radial = base.x_axis * c1 + base.y_axis * s1;
        let sideways = base.y_axis * c1 - base.x_axis * s1;
        let axial = base.z_axis;

        Self {
            radial,
            axial,
            radius: l2 + l3 * c2 + l4 * c23,
            height: l3 * s2 + l4 * s23,
            sin_theta3: s3,
            cos_theta3: c3,
            rotation: DMat3::from_cols(
                radial * c23 + axial * s23,
                axial * c23 - radial * s23,
                -sideways,
            ),
        }
    }

    /// Fingertip position in `W` (m).
    pub(super) fn position(&self, finger: &ThreeJoints) -> DVec3 {
        finger.base_position + self.radial * self.radius + self.axial * self.height
    }

    /// Jacobian of eq. (2) (m/rad).
    pub(super) fn jacobian(&self, finger: &ThreeJoints) -> DMat3 {
        let [_, l3, l4] = finger.links;
        let r = &self.rotation;
        DMat3::from_cols(
            -r.z_axis * self.radius,
            (r.x_axis * self.sin_theta3 + r.y_axis * self.cos_theta3) * l3 + r.y_axis * l4,
            r.y_axis * l4,
        )
    }
}
