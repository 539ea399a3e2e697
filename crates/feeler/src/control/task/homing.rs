//! Return motion of a finger.

use glam::DVec3;

/// Time constant of the return (s): the velocity is the distance from home over this time, limited to the return
/// speed.
const HOMING_TIME: f64 = 0.1;

/// Velocity of a finger that returns at up to `speed` (m/s) and whose home is at the offset `way` (m).
pub fn homeward(way: DVec3, speed: f64) -> DVec3 {
    (way / HOMING_TIME).clamp_length_max(speed)
}
