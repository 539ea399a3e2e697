//! Forward kinematics and Jacobian of a chain.

use super::{Chain, MAX_FRAMES, MAX_JOINTS, Segment};
use crate::hand::joint_vector::JointVector;
use crate::hand::sin_cos::sin_cos_of;
use glam::{DMat3, DVec3};

/// Displacement at which a prismatic frame saturates (m), to prevent overflow of products of lengths.
const DISPLACEMENT_RANGE: f64 = 1e9;

/// Intermediate results at one set of joint positions, shared by the pose and the Jacobian.
pub(super) struct State {
    /// Axes of the moving frames in `W`.
    axes: [DVec3; MAX_FRAMES],
    /// Origins of the moving frames in `W`, relative to that of the first (m). Because the base's position is excluded,
    /// the Jacobian is accurate at any distance from the origin of `W`.
    origins: [DVec3; MAX_FRAMES],
    /// Fingertip position in `W`, relative to the origin of the first moving frame at position 0 (m).
    tip: DVec3,
    rotation: DMat3,
}

impl State {
    #[inline]
    pub(super) fn at(chain: &Chain, joints: &[f64]) -> Self {
        let mut state = Self {
            axes: [DVec3::ZERO; MAX_FRAMES],
            origins: [DVec3::ZERO; MAX_FRAMES],
            tip: DVec3::ZERO,
            rotation: chain.rotation,
        };
        let frames = state.axes.iter_mut().zip(&mut state.origins);
        for (segment, (axis, origin)) in chain.segments.iter().zip(frames) {
            *axis = state.rotation.z_axis;
            *origin = state.tip;
            let position = position_of(segment, joints);
            if segment.prismatic {
                state.tip += *axis * position.clamp(-DISPLACEMENT_RANGE, DISPLACEMENT_RANGE);
            } else {
                let (sin, cos) = sin_cos_of(position);
                let (x, y) = (state.rotation.x_axis, state.rotation.y_axis);
                state.rotation.x_axis = x * cos + y * sin;
                state.rotation.y_axis = y * cos - x * sin;
            }
            state.tip += state.rotation * segment.translation;
            state.rotation *= segment.rotation;
        }
        state
    }

    /// Fingertip position in `W` (m).
    pub(super) fn position(&self, chain: &Chain) -> DVec3 {
        chain.origin + self.tip
    }

    /// Columns of the Jacobian (m/rad or m/m).
    #[inline]
    pub(super) fn jacobian(&self, chain: &Chain) -> [DVec3; MAX_JOINTS] {
        let mut columns = [DVec3::ZERO; MAX_JOINTS];
        let frames = self.axes.iter().zip(&self.origins);
        for (segment, (axis, origin)) in chain.segments.iter().zip(frames) {
            let velocity = if segment.prismatic {
                *axis
            } else {
                axis.cross(self.tip - *origin)
            };
            columns[segment.joint] += velocity * segment.multiplier;
        }
        columns
    }
}

/// Position of a moving frame (rad or m). Finite for a finite joint position, NaN for any other.
#[inline]
fn position_of(segment: &Segment, joints: &[f64]) -> f64 {
    let Some(&joint) = joints.get(segment.joint).filter(|q| q.is_finite()) else {
        return f64::NAN;
    };
    (segment.multiplier * joint + segment.offset).clamp(f64::MIN, f64::MAX)
}

impl Chain {
    /// Returns the fingertip pose at `joints` (rad or m).
    ///
    /// The position is the dome's centre, the origin of the fingertip frame `T`, in the world `W` (m). The rotation
    /// transforms vectors from `T` to `W`. Finite arguments give a finite result; a prismatic frame saturates at 1e9 m.
    /// Any other argument makes the result NaN.
    #[inline]
    pub fn pose(&self, joints: &[f64]) -> (DVec3, DMat3) {
        let state = State::at(self, joints);
        (state.position(self), state.rotation)
    }

    /// Returns the Jacobian at `joints` (rad or m): `r_dot = sum J_j q_dot_j`.
    ///
    /// Column j is the fingertip velocity in `W` per unit velocity of joint j (m/rad, or m/m for a prismatic joint).
    #[inline]
    pub fn jacobian(&self, joints: &[f64]) -> [DVec3; MAX_JOINTS] {
        State::at(self, joints).jacobian(self)
    }

    /// Returns the [`pose`](Self::pose) and the [`jacobian`](Self::jacobian) at `joints` (rad or m), faster than by two
    /// calls.
    #[inline]
    pub fn pose_and_jacobian(&self, joints: &[f64]) -> (DVec3, DMat3, [DVec3; MAX_JOINTS]) {
        let state = State::at(self, joints);
        (state.position(self), state.rotation, state.jacobian(self))
    }

    /// Position of the moving frame `index` (rad or m) at `joints` (rad or m).
    pub(in crate::hand) fn frame_position(&self, index: usize, joints: &[f64]) -> f64 {
        position_of(&self.segments[index], joints)
    }

    /// Velocity of the moving frame `index` (rad/s or m/s) at the joint velocities `velocities`.
    pub(in crate::hand) fn frame_velocity(&self, index: usize, velocities: &JointVector) -> f64 {
        let segment = &self.segments[index];
        segment.multiplier * velocities[segment.joint]
    }

    /// Origins in `W` (m) of the base, of the moving frames and of the fingertip at `joints` (rad or m).
    pub(in crate::hand) fn skeleton(&self, joints: &[f64]) -> Vec<DVec3> {
        let state = State::at(self, joints);
        let origins = state.origins.iter().take(self.segments.len());
        let origins = origins.map(|origin| self.origin + *origin);
        let base = std::iter::once(self.base_position);
        base.chain(origins).chain([state.position(self)]).collect()
    }
}
