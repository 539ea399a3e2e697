//! Kinematics of a finger of one to seven independent joints, with coupled joints.
//!
//! A chain consists of moving frames. Each has a constant transform from the previous frame, and turns about or moves
//! along its axis by `multiplier * q_j + offset`, where q_j is the position of an independent joint. Rows with the same
//! joint are coupled, for example by a tendon. After the last frame a constant transform leads to the fingertip frame
//! `T`: its origin is the dome's centre, its x axis the dome's outward axis. So a parallel gripper is a chain with one
//! prismatic joint. Positions q are in rad or m, fingertip positions in the world `W` (m).
//!
//! With unit axis z_i and origin o_i of the moving frame i, multiplier m_i, and fingertip position r, column j of the
//! Jacobian is the sum over the frames that joint j drives:
//!
//! ```text
//! J_j = sum m_i z_i x (r - o_i)   (revolute)   + sum m_i z_i   (prismatic)
//! ```
//!
//! Joint positions are slices. A missing entry counts as NaN, additional entries are ignored. Returned arrays have an
//! entry per joint and are 0 beyond. [`Chain::pose`], [`Chain::jacobian`] and [`Chain::resolved_rate`] do not allocate.

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
pub use error::{ChainError, ChainKinematicsError};
pub use resolved_rate::ChainRate;

use glam::{DMat3, DVec3};
use task_rank::TaskRanks;

/// Maximum number of independent joints of a chain.
pub const MAX_JOINTS: usize = 7;

/// Maximum number of moving frames of a chain.
pub const MAX_FRAMES: usize = 16;

/// A checked [`ChainConfig`] with precomputed transforms.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
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

/// A moving frame, whose z axis is the axis of the motion, and the transform to the next one.
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
    /// Position units per scaled unit: 1 for an angle, the chain's reach for a displacement.
    scale: f64,
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
    /// Checks `config` and precomputes the transforms.
    ///
    /// # Errors
    /// If a value is not finite or outside of the range that its field documents, or the rows and joints do not refer
    /// to each other as documented.
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
        for (index, value) in prismatic.iter_mut().enumerate().take(self.joint_count()) {
            let mut driven = self.segments.iter().filter(|s| s.joint == index);
            *value = driven.all(|segment| segment.prismatic);
        }
        prismatic
    }

    /// Upper bound of the distance from the first moving frame's origin to the fingertip within the joint limits (m).
    pub fn reach(&self) -> f64 {
        self.reach
    }

    fn each(&self, value: impl Fn(&Joint) -> f64) -> [f64; MAX_JOINTS] {
        let mut values = [0.0; MAX_JOINTS];
        for (value_of, joint) in values.iter_mut().zip(&self.joints) {
            *value_of = value(joint);
        }
        values
    }
}
