//! The time of a rig, which may go slower than real time where the rig is emulated.

use std::time::{Duration, Instant};

/// Monotonic time since the rig was set up.
#[derive(Debug, Clone, Copy)]
pub struct RigClock {
    origin: Instant,
    speed: f64,
}

impl RigClock {
    /// Real time, from now on.
    pub fn real() -> Self {
        Self::at_speed(1.0)
    }

    /// Time that goes `speed` times as fast as real time: above 0, and 1 for all that is not emulated.
    pub fn at_speed(speed: f64) -> Self {
        Self {
            origin: Instant::now(),
            speed,
        }
    }

    /// Seconds of the rig's time since it began.
    pub fn now(&self) -> f64 {
        self.origin.elapsed().as_secs_f64() * self.speed
    }

    /// How long so many `seconds` of the rig's time take; none where they are none.
    pub fn real_time(&self, seconds: f64) -> Duration {
        Duration::try_from_secs_f64(seconds / self.speed).unwrap_or_default()
    }

    /// Seconds of the rig's time in a second.
    pub fn speed(&self) -> f64 {
        self.speed
    }
}
