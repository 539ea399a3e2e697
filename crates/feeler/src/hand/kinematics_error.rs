//! Why a finger cannot bring its tip to where it is asked to.

use glam::DVec3;

/// Largest distance of the fingertip from its target that counts as reached, m.
pub const POSITION_TOLERANCE: f64 = 1e-9;

/// Why there are no joint angles for a fingertip position.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KinematicsError {
    /// An argument is NaN or infinite.
    #[error("expected a finite target and start, got target {target} m and start {start} rad")]
    NotFinite {
        /// The wanted fingertip position in `W`, m.
        target: DVec3,
        /// The joint angles to start from, rad.
        start: DVec3,
    },
    /// The target is too far or too near, whatever the joint limits.
    #[error(
        "fingertip target {target} m is {distance:.6} m from the shoulder, \
         the finger reaches {minimum:.6}..{maximum:.6} m"
    )]
    OutOfReach {
        /// The wanted fingertip position in `W`, m.
        target: DVec3,
        /// Distance of the target from joint 2, turned towards the target, m.
        distance: f64,
        /// Smallest reachable distance, |l3 - l4|, m.
        minimum: f64,
        /// Largest reachable distance, l3 + l4, m.
        maximum: f64,
    },
    /// Every posture that reaches the target breaks a joint limit.
    #[error(
        "fingertip target {target} m needs joint angles {theta} rad, the limits are {lower}..{upper} rad"
    )]
    OutsideJointLimits {
        /// The wanted fingertip position in `W`, m.
        target: DVec3,
        /// Joint angles of the posture that exceeds the limits least, rad.
        theta: DVec3,
        /// Smallest joint angles, rad.
        lower: DVec3,
        /// Largest joint angles, rad.
        upper: DVec3,
    },
    /// The iteration ended away from the target although the target is within reach.
    #[error(
        "expected a fingertip within {POSITION_TOLERANCE:e} m of {target} m, ended {residual:e} m away"
    )]
    NotConverged {
        /// The wanted fingertip position in `W`, m.
        target: DVec3,
        /// Distance from the target at the end, m.
        residual: f64,
    },
}
