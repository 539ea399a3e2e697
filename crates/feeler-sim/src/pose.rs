//! Where a rigid thing is.

use glam::{DMat3, DVec3};

/// Position and rotation of a rigid thing in W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Its origin, m.
    pub position: DVec3,
    /// From its frame to W.
    pub rotation: DMat3,
}

impl Pose {
    /// The pose of something that stands at W's origin.
    pub const IDENTITY: Self = Self {
        position: DVec3::ZERO,
        rotation: DMat3::IDENTITY,
    };

    /// This pose as seen from `frame`, both given in W.
    pub fn seen_from(&self, frame: &Self) -> Self {
        let to_frame = frame.rotation.transpose();
        Self {
            position: to_frame * (self.position - frame.position),
            rotation: to_frame * self.rotation,
        }
    }

    /// The point in W of `point` in this frame, m.
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        self.position + self.rotation * point
    }

    /// Rotation vector from the rotation `before` to this one, rad; for small turns.
    pub fn turn_since(&self, before: &DMat3) -> DVec3 {
        let now = &self.rotation;
        let twice = before.x_axis.cross(now.x_axis)
            + before.y_axis.cross(now.y_axis)
            + before.z_axis.cross(now.z_axis);
        0.5 * twice
    }

    /// By how much any point within `reach` (m) of the origin has moved at most since `before`, m.
    pub fn motion_since(&self, before: &Self, reach: f64) -> f64 {
        let turn = self.rotation - before.rotation;
        let columns = [turn.x_axis, turn.y_axis, turn.z_axis];
        // No vector is stretched by more than the Frobenius norm.
        let frobenius = columns
            .map(DVec3::length_squared)
            .iter()
            .sum::<f64>()
            .sqrt();
        self.position.distance(before.position) + reach * frobenius
    }
}
