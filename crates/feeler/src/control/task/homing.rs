//! Motion of a finger that returns home.

use glam::DVec3;

/// Time constant of the return (s): the velocity is the distance from home divided by this time, limited to the return
/// speed.
const HOMING_TIME: f64 = 0.1;

/// Velocity of a finger that returns home at up to `speed` (m/s). `way` is the vector from the finger to its home (m).
pub fn homeward(way: DVec3, speed: f64) -> DVec3 {
    (way / HOMING_TIME).clamp_length_max(speed)
}
