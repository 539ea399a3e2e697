//! Time of a rig. If the rig is emulated, time may be slower than real time, or advance only during waits (lockstep).

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Monotonic time since the rig was set up. Clones share the same time.
#[derive(Debug, Clone)]
pub struct RigClock(Source);

#[derive(Debug, Clone)]
enum Source {
    /// Real time multiplied by `speed`.
    Real { origin: Instant, speed: f64 },
    /// Simulated time (s, as the bits of an `f64`), which an emulated bus advances.
    Lockstep(Arc<AtomicU64>),
}

impl RigClock {
    /// Real time, starting at 0 now.
    pub fn real() -> Self {
        Self::at_speed(1.0)
    }

    /// Time that runs `speed` times as fast as real time. `speed` must be above 0, and 1 for real hardware.
    pub fn at_speed(speed: f64) -> Self {
        Self(Source::Real {
            origin: Instant::now(),
            speed,
        })
    }

    /// Time that advances only by [`set`](Self::set).
    pub(crate) fn lockstep() -> Self {
        Self(Source::Lockstep(Arc::new(AtomicU64::new(
            0.0_f64.to_bits(),
        ))))
    }

    /// Sets the time of a clock in lockstep, s. Does not affect real time.
    pub(crate) fn set(&self, now: f64) {
        if let Source::Lockstep(time) = &self.0 {
            time.store(now.to_bits(), Ordering::Release);
        }
    }

    /// Current time of the rig, s.
    pub fn now(&self) -> f64 {
        match &self.0 {
            Source::Real { origin, speed } => origin.elapsed().as_secs_f64() * speed,
            Source::Lockstep(time) => f64::from_bits(time.load(Ordering::Acquire)),
        }
    }

    /// Converts `seconds` of the rig's time to real time; zero if negative or in lockstep.
    pub fn real_time(&self, seconds: f64) -> Duration {
        let seconds = match self.0 {
            Source::Real { speed, .. } => seconds / speed,
            Source::Lockstep(_) => 0.0,
        };
        Duration::try_from_secs_f64(seconds).unwrap_or_default()
    }
}
