//! What a task wants of a finger.

use glam::DVec3;

/// What the task wants of a finger until further notice.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plan {
    /// Velocity of the fingertip, m/s, in W: v_0 in SEARCH, v_m in MOVE.
    pub velocity: DVec3,
    /// Where the object is thought to be: a unit vector in W.
    pub towards_object: DVec3,
    /// Whether the finger re-compresses when it slips.
    pub reflex: bool,
    /// Whether the finger re-compresses when its grasp force is low.
    pub keep_grasp: bool,
}
