//! Kinematics of a finger of one to seven independent joints, with coupled joints.
//!
//! A chain consists of moving frames. Each has a constant transform from the previous frame, and turns about or moves
//! along its axis by `multiplier * q_j + offset`, where q_j is the position of an independent joint. Frames with the same
//! joint are coupled, for example by a tendon. After the last frame a constant transform leads to the fingertip frame
//! `T`: its origin is the dome's centre, its x axis the dome's outward axis. Each finger of a parallel gripper, for
//! example, is a chain with one prismatic joint. Positions q are in rad or m, fingertip positions in the world `W` (m).
//!
//! With unit axis z_i and origin o_i of the moving frame i, multiplier m_i, and fingertip position r, column j of the
//! Jacobian is the sum over the frames that joint j drives:
//!
//! ```text
//! J_j = sum m_i z_i x (r - o_i)   (revolute)   + sum m_i z_i   (prismatic)
//! ```
//!
//! Joint positions are slices. A missing entry counts as NaN, additional entries are ignored. Returned arrays have one
//! entry per joint, followed by zeros. [`Chain::pose`], [`Chain::jacobian`] and [`Chain::resolved_rate`] do not
//! allocate.

mod build;
mod check;
mod config;
mod error;
mod inverse_kinematics;
mod kinematics;
mod resolved_rate;
mod solve;
mod spectrum;
mod task_rank;

pub use config::{ChainConfig, DhRow, FrameRow, JointConfig, MimicConfig, RowType};
pub use error::ChainError;
pub use resolved_rate::ChainRate;

use super::joint_vector::JointVector;
pub use super::joint_vector::MAX_JOINTS;
pub use super::kinematics_error::ChainKinematicsError;
use glam::{DMat3, DVec3};
use task_rank::TaskRanks;

/// Maximum number of moving frames of a chain.
pub const MAX_FRAMES: usize = 16;

/// Kinematic chain of a finger: a checked [`ChainConfig`] with precomputed transforms.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Origin of the finger base, in `W` (m).
    base_position: DVec3,
    /// Origin of the first moving frame at position 0, in `W` (m).
    origin: DVec3,
    /// Rotation of the first moving frame at position 0.
    rotation: DMat3,
    segments: Vec<Segment>,
    joints: Vec<Joint>,
    reach: f64,
    damping_threshold: f64,
    ranks: TaskRanks,
}

/// Moving frame with the motion about or along its z axis, and the transform to the next frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Segment {
    prismatic: bool,
    joint: usize,
    multiplier: f64,
    offset: f64,
    /// Origin of the next frame (or `T`) in this one, at position 0 of the next frame (m).
    translation: DVec3,
    /// Rotation of the next frame (or `T`) in this one.
    rotation: DMat3,
}

/// An independent joint.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Joint {
    lower: f64,
    upper: f64,
    speed: f64,
    /// Change of the position that corresponds to one scaled unit.
    scale: f64,
    /// `true` if the position is a displacement (m), `false` for an angle (rad).
    prismatic: bool,
}

/// Moving frame of a chain, for drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFrame {
    /// Origin in the previous moving frame, or in `W` for the first frame (m), at position 0.
    pub translation: DVec3,
    /// Rotation from this frame to the previous one, or to `W`, at position 0. The frame rotates about or moves along
    /// its z axis.
    pub rotation: DMat3,
    /// `true` if the frame moves along z (m), `false` if it rotates about z (rad).
    pub prismatic: bool,
    /// Index of the independent joint that drives the frame.
    pub joint: usize,
    /// Change of the frame's position per change of the joint's position (m/rad or rad/m if their units differ).
    pub multiplier: f64,
    /// Position of the frame at joint position 0 (rad or m).
    pub offset: f64,
}

impl Joint {
    fn middle(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    fn half_range(&self) -> f64 {
        0.5 * (self.upper - self.lower)
    }
}

impl Chain {
    /// Builds a chain from `config`.
    ///
    /// # Errors
    /// If a value is not finite or outside the range documented for its field, or if rows and joints do not refer to
    /// each other as documented.
    pub fn new(config: &ChainConfig) -> Result<Self, ChainError> {
        build::build(config)
    }

    /// Number of independent joints, 1 to [`MAX_JOINTS`].
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Lower limits of the joints (rad or m).
    pub fn joint_lower(&self) -> [f64; MAX_JOINTS] {
        self.each(|joint| joint.lower)
    }

    /// Upper limits of the joints (rad or m).
    pub fn joint_upper(&self) -> [f64; MAX_JOINTS] {
        self.each(|joint| joint.upper)
    }

    /// Maximum speeds of the joints in either direction (rad/s or m/s).
    pub fn joint_speed_limit(&self) -> [f64; MAX_JOINTS] {
        self.each(|joint| joint.speed)
    }

    /// `true` for each joint whose position is a displacement (m), `false` for an angle (rad).
    pub fn is_prismatic(&self) -> [bool; MAX_JOINTS] {
        let mut prismatic = [false; MAX_JOINTS];
        for (value, joint) in prismatic.iter_mut().zip(&self.joints) {
            *value = joint.prismatic;
        }
        prismatic
    }

    /// Upper bound of the distance from the first moving frame's origin to the fingertip within the joint limits (m).
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Upper bounds of the speed of any point within `radius` (m) of the fingertip, per unit speed of each joint (m/rad
    /// or m/m).
    pub(super) fn lever_arms(&self, radius: f64) -> JointVector {
        let mut arms = JointVector::zeros(self.joint_count());
        let mut arm = radius;
        for segment in self.segments.iter().rev() {
            arm += segment.translation.length();
            let factor = segment.multiplier.abs();
            arms[segment.joint] += factor * if segment.prismatic { 1.0 } else { arm };
            if segment.prismatic {
                let joint = &self.joints[segment.joint];
                let travel = |q: f64| (segment.multiplier * q + segment.offset).abs();
                arm += travel(joint.lower).max(travel(joint.upper));
            }
        }
        arms
    }

    /// Origin of the finger base in the world `W` (m).
    pub fn base_position(&self) -> DVec3 {
        self.base_position
    }

    /// Number of moving frames, at most [`MAX_FRAMES`].
    pub(super) fn frame_count(&self) -> usize {
        self.segments.len()
    }

    /// Moving frames, from the base to the fingertip.
    pub fn frames(&self) -> impl Iterator<Item = MovingFrame> + '_ {
        let first = (self.origin, self.rotation);
        let poses = self.segments.iter().map(|s| (s.translation, s.rotation));
        let poses = std::iter::once(first).chain(poses);
        let frames = self.segments.iter().zip(poses);
        frames.map(|(segment, (translation, rotation))| MovingFrame {
            translation,
            rotation,
            prismatic: segment.prismatic,
            joint: segment.joint,
            multiplier: segment.multiplier,
            offset: segment.offset,
        })
    }

    /// Pose of the fingertip frame `T` in the last moving frame: origin (m), and rotation from `T` to that frame.
    pub fn tip(&self) -> (DVec3, DMat3) {
        let last = self.segments.last();
        last.map_or((DVec3::ZERO, DMat3::IDENTITY), |s| {
            (s.translation, s.rotation)
        })
    }

    fn each(&self, value: impl Fn(&Joint) -> f64) -> [f64; MAX_JOINTS] {
        let mut values = [0.0; MAX_JOINTS];
        for (value_of, joint) in values.iter_mut().zip(&self.joints) {
            *value_of = value(joint);
        }
        values
    }
}
