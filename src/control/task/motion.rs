//! Motions that several tasks have in common.

use super::super::stop_reason::StopReason;
use glam::DVec3;

/// A finger that returns has a velocity of its distance from home over this time, s, and no more
/// than the return speed.
const HOMING_TIME: f64 = 0.1;

/// Velocity, m/s, that brings a finger from `position` to `goal` (m), at most at `speed`.
pub fn towards(goal: DVec3, position: DVec3, speed: f64) -> DVec3 {
    ((goal - position) / HOMING_TIME).clamp_length_max(speed)
}

/// Gives up a search that has come further than `limit`, m, without finding anything.
///
/// # Errors
/// When `travel` is more than `limit`.
pub fn check_search(finger: usize, travel: f64, limit: f64) -> Result<(), StopReason> {
    if travel > limit {
        return Err(StopReason::NothingToGrasp {
            finger,
            travel,
            limit,
        });
    }
    Ok(())
}
