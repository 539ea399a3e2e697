//! Motion that a task plans for a finger.

use glam::DVec3;

/// Motion that the task requests of a finger until the next plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plan {
    /// Velocity of the fingertip (m/s, in W): v_0 in the phase SEARCH, v_m in MOVE.
    pub velocity: DVec3,
    /// Assumed direction towards the object, a unit vector in W.
    pub towards_object: DVec3,
    /// `true` if the finger must be pressed into the object (re-compressed) when it slips.
    pub reflex: bool,
    /// `true` if the finger must be pressed into the object (re-compressed) when its grasp force is low.
    pub keep_grasp: bool,
}
