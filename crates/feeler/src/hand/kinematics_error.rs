//! Errors of the inverse kinematics.

use super::joint_vector::{JointVector, MAX_JOINTS};
use glam::DVec3;

/// Maximum distance of the fingertip from its target for the target to count as reached (m).
pub const POSITION_TOLERANCE: f64 = 1e-9;

/// Error of the inverse kinematics of a finger.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KinematicsError {
    /// An argument is NaN or infinite.
    #[error("expected a finite target and start, got target {target} m and start {start} rad")]
    NotFinite {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Initial joint angles (rad).
        start: JointVector,
    },
    /// The target is too far away or too near for the links, regardless of the joint limits.
    #[error(
        "fingertip target {target} m is {distance:.6} m from joint 2, \
         expected {minimum:.6}..{maximum:.6} m"
    )]
    OutOfReach {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Distance from joint 2 to the target, if joint 1 is turned towards the target (m).
        distance: f64,
        /// Minimum reachable distance, |l3 - l4| (m).
        minimum: f64,
        /// Maximum reachable distance, l3 + l4 (m).
        maximum: f64,
    },
    /// Every posture that reaches the target violates a joint limit.
    #[error(
        "fingertip target {target} m needs joint angles {theta} rad, the limits are {}..{} rad",
        limits.0,
        limits.1
    )]
    OutsideJointLimits {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Joint angles of the posture with the smallest limit violation (rad).
        theta: JointVector,
        /// Lower and upper limits of the joint angles (rad).
        limits: Box<(JointVector, JointVector)>,
    },
    /// The iteration did not converge although the target is within reach.
    #[error(
        "expected a fingertip within {POSITION_TOLERANCE:e} m of {target} m, ended {residual:e} m away"
    )]
    NotConverged {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Final distance from the target (m).
        residual: f64,
    },
    /// No joint positions of a chain were found.
    #[error(transparent)]
    Chain(#[from] ChainKinematicsError),
}

/// Error returned if no joint positions of a chain are found for a fingertip position.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChainKinematicsError {
    /// An argument is NaN or infinite, or a joint is missing.
    #[error(
        "expected a finite target and {expected} finite joint positions, got target {target} m and start {start:?}"
    )]
    NotFinite {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Initial joint positions (rad or m), NaN if missing.
        start: [f64; MAX_JOINTS],
        /// Number of joints.
        expected: usize,
    },
    /// The target is beyond the reach of the links, regardless of the joint limits.
    #[error(
        "fingertip target {target} m is {distance:.6} m from the first joint, expected at most {maximum:.6} m"
    )]
    OutOfReach {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Distance from the origin of the first moving frame to the target (m).
        distance: f64,
        /// Upper bound of the reachable distance (m).
        maximum: f64,
    },
    /// The iteration did not reach the target within the joint limits. The target may be unreachable.
    #[error(
        "expected a fingertip within {POSITION_TOLERANCE:e} m of {target} m and joints within their limits, \
         ended {residual:e} m away"
    )]
    NotConverged {
        /// Target position of the fingertip in `W` (m).
        target: DVec3,
        /// Smallest distance from the target that was reached (m).
        residual: f64,
        /// Joint positions at that distance (rad or m), within the limits.
        joints: [f64; MAX_JOINTS],
    },
}
