//! Closed-form kinematics of a finger with the three joints of the paper.

mod inverse_kinematics;
mod kinematics;
mod postures;
mod resolved_rate;

use super::finger::FingerConfig;
use crate::math::{rotation_x, rotation_y};
use glam::{DMat3, DVec3};
use kinematics::Posture;

/// Kinematics of a finger with the paper's three joints, with the base rotation precomputed.
#[derive(Debug, Clone, PartialEq)]
pub struct ThreeJoints {
    base_position: DVec3,
    base_angles: (f64, f64),
    base_rotation: DMat3,
    links: [f64; 3],
    /// Lower limits of theta1..theta3 (rad).
    lower: DVec3,
    /// Upper limits of theta1..theta3 (rad).
    upper: DVec3,
}

impl ThreeJoints {
    /// Creates the kinematics from a checked `config`, and precomputes the base rotation.
    pub(super) fn new(config: &FingerConfig) -> Self {
        let (phi1, phi2) = (config.phi1_deg.to_radians(), config.phi2_deg.to_radians());
        Self {
            base_position: DVec3::from_array(config.base_position),
            base_angles: (phi1, phi2),
            base_rotation: rotation_y(phi1) * rotation_x(phi2),
            links: config.links,
            lower: DVec3::from_array(config.joint_lower_deg.map(f64::to_radians)),
            upper: DVec3::from_array(config.joint_upper_deg.map(f64::to_radians)),
        }
    }

    /// Origin of the finger base `B`, on the axis of joint 1, in the world `W` (m).
    pub fn base_position(&self) -> DVec3 {
        self.base_position
    }

    /// Rotation of the finger base, `Ry(phi1) Rx(phi2)`. It transforms vectors from `B` to `W`.
    pub fn base_rotation(&self) -> DMat3 {
        self.base_rotation
    }

    /// Angles phi1 and phi2 of the finger base (rad).
    pub fn base_angles(&self) -> (f64, f64) {
        self.base_angles
    }

    /// Link lengths l2, l3 and l4 (m).
    pub fn links(&self) -> [f64; 3] {
        self.links
    }

    /// Fingertip pose at the joint angles `theta` (rad): position in `W` (m), and rotation from `T` to `W`.
    #[inline(always)]
    pub(super) fn pose(&self, theta: DVec3) -> (DVec3, DMat3) {
        let posture = Posture::at(self, theta);
        (posture.position(self), posture.rotation)
    }

    /// Jacobian of eq. (2) at the joint angles `theta` (rad), in m/rad. The first column is always orthogonal to the
    /// other two.
    pub(super) fn jacobian(&self, theta: DVec3) -> DMat3 {
        Posture::at(self, theta).jacobian(self)
    }

    /// Origins of the base, of joints 2 and 3 and of the fingertip in `W` (m), at the angle `theta1` of joint 1 (rad)
    /// and the fingertip pose `tip`.
    pub(super) fn skeleton(&self, theta1: f64, tip: (DVec3, DMat3)) -> [DVec3; 4] {
        let [l2, _, l4] = self.links;
        let (sin, cos) = libm::sincos(theta1);
        let base = self.base_rotation;
        let shoulder = self.base_position + l2 * (base.x_axis * cos + base.y_axis * sin);
        let (position, rotation) = tip;
        [
            self.base_position,
            shoulder,
            position - l4 * rotation.x_axis,
            position,
        ]
    }
}
