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

/// A motion of a frame about its own z axis and along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw {
    /// Of the angle by which it turns.
    pub sine: f64,
    /// Of the same.
    pub cosine: f64,
    /// How far it moves along z, m.
    pub advance: f64,
}

impl Screw {
    /// The pose, as seen from the frame after it has moved, of what was at `seen` before.
    #[inline(always)]
    pub fn seen_after(&self, seen: &Pose) -> Pose {
        let back = |v: DVec3| {
            let x = self.cosine * v.x + self.sine * v.y;
            DVec3::new(x, self.cosine * v.y - self.sine * v.x, v.z)
        };
        let DMat3 {
            x_axis,
            y_axis,
            z_axis,
        } = seen.rotation;
        let mut position = back(seen.position);
        position.z -= self.advance;
        Pose {
            position,
            rotation: DMat3::from_cols(back(x_axis), back(y_axis), back(z_axis)),
        }
    }
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
