//! The way home.

use glam::DVec3;

/// A finger that returns has a velocity of its distance from home over this time, s, and no more
/// than the return speed.
const HOMING_TIME: f64 = 0.1;

/// Velocity of a finger whose home is at `way` from it (m) and which may return at `speed` (m/s).
pub fn homeward(way: DVec3, speed: f64) -> DVec3 {
    (way / HOMING_TIME).clamp_length_max(speed)
}
