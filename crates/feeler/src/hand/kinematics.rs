//! Forward kinematics and Jacobian of a finger, eqs. (2) and (3).

use glam::{DMat3, DVec3};

use super::finger::FingerGeometry;
use super::joint_vector::JointVector;
use super::sin_cos::sin_cos;

/// Returns the fingertip pose at joint angles `theta` (theta1..theta3, rad).
///
/// The position `r` is the dome's centre, the origin of the fingertip frame `T`, in the world `W` (m). The rotation
/// `R` of eq. (3) transforms vectors from `T` to `W`. Its first column, the x axis of `T`, is the direction of the
/// last link and the dome's outward axis.
#[inline(always)]
pub fn fingertip_pose(geometry: &FingerGeometry, theta: JointVector) -> (DVec3, DMat3) {
    let chain = Chain::at(geometry, three(theta));
    (chain.position(geometry), chain.rotation)
}

/// Returns the Jacobian of eq. (2) at joint angles `theta` (rad): `r_dot = J theta_dot`.
///
/// Column i is the fingertip velocity in `W` per unit velocity of joint i (m/rad). The first column is always
/// orthogonal to the other two.
pub fn jacobian(geometry: &FingerGeometry, theta: JointVector) -> DMat3 {
    Chain::at(geometry, three(theta)).jacobian(geometry)
}

/// Numbers of the three joints of the paper's finger, theta1..theta3.
#[inline(always)]
pub(super) fn three(joints: JointVector) -> DVec3 {
    DVec3::new(joints[0], joints[1], joints[2])
}

/// Intermediate results at one set of joint angles, shared by the pose and the Jacobian.
pub(super) struct Chain {
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
    /// R of eq. (3).
    rotation: DMat3,
}

impl Chain {
    #[inline(always)]
    pub(super) fn at(geometry: &FingerGeometry, theta: DVec3) -> Self {
        let (sines, cosines) = sin_cos(theta);
        let ([s1, s2, s3], [c1, c2, c3]) = (sines.to_array(), cosines.to_array());
        // The sum formulas avoid an overflow of theta2 + theta3.
        let (s23, c23) = (s2 * c3 + c2 * s3, c2 * c3 - s2 * s3);
        let [l2, l3, l4] = geometry.links();

        // The columns of a = Ry(phi1) Rx(phi2) Rz(theta1).
        let base = geometry.base_rotation();
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
    pub(super) fn position(&self, geometry: &FingerGeometry) -> DVec3 {
        geometry.base_position() + self.radial * self.radius + self.axial * self.height
    }

    /// Jacobian of eq. (2) (m/rad).
    pub(super) fn jacobian(&self, geometry: &FingerGeometry) -> DMat3 {
        let [_, l3, l4] = geometry.links();
        let r = &self.rotation;
        DMat3::from_cols(
            -r.z_axis * self.radius,
            (r.x_axis * self.sin_theta3 + r.y_axis * self.cos_theta3) * l3 + r.y_axis * l4,
            r.y_axis * l4,
        )
    }
}
