//! Poses of rigid bodies, and their relative motion.

use glam::{DMat3, DVec3};

/// Position and rotation of a frame in W, or in another frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position of the origin (m).
    pub position: DVec3,
    /// Rotation from this frame to W.
    pub rotation: DMat3,
}

/// Screw motion of a frame about and along its z axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Screw {
    /// Sine of the rotation angle.
    pub sine: f64,
    /// Cosine of the rotation angle.
    pub cosine: f64,
    /// Translation along z (m).
    pub advance: f64,
}

impl Screw {
    /// Converts the pose `seen` relative to the frame before the motion to the pose relative to the frame after it.
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
    /// Pose of the world frame.
    pub const IDENTITY: Self = Self {
        position: DVec3::ZERO,
        rotation: DMat3::IDENTITY,
    };

    /// This pose relative to `frame`; both given in W.
    pub fn relative_to(&self, frame: &Self) -> Self {
        let to_frame = frame.rotation.transpose();
        Self {
            position: to_frame * (self.position - frame.position),
            rotation: to_frame * self.rotation,
        }
    }

    /// Transforms `point` from this frame to W (m).
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        self.position + self.rotation * point
    }

    /// Rotation vector from `before` to the current rotation (rad); for small angles.
    pub fn turn_since(&self, before: &DMat3) -> DVec3 {
        let now = &self.rotation;
        let twice = before.x_axis.cross(now.x_axis)
            + before.y_axis.cross(now.y_axis)
            + before.z_axis.cross(now.z_axis);
        0.5 * twice
    }

    /// Upper bound of the displacement since `before` of any point within `reach` (m) of the origin (m).
    pub fn motion_since(&self, before: &Self, reach: f64) -> f64 {
        let turn = self.rotation - before.rotation;
        let columns = [turn.x_axis, turn.y_axis, turn.z_axis];
        // The Frobenius norm is an upper bound of the spectral norm.
        let frobenius = columns
            .map(DVec3::length_squared)
            .iter()
            .sum::<f64>()
            .sqrt();
        self.position.distance(before.position) + reach * frobenius
    }
}
