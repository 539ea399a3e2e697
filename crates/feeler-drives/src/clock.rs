//! The time of a rig, which may go slower than real time, or only when something is waited for, where the rig is emulated.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Monotonic time since the rig was set up. All clones show the same.
#[derive(Debug, Clone)]
pub struct RigClock(Source);

#[derive(Debug, Clone)]
enum Source {
    /// Real time, so many times as fast.
    Real { origin: Instant, speed: f64 },
    /// The bits of a time, s, that an emulated bus moves on.
    Lockstep(Arc<AtomicU64>),
}

impl RigClock {
    /// Real time, from now on.
    pub fn real() -> Self {
        Self::at_speed(1.0)
    }

    /// Time that goes `speed` times as fast as real time: above 0, and 1 for all that is not emulated.
    pub fn at_speed(speed: f64) -> Self {
        Self(Source::Real {
            origin: Instant::now(),
            speed,
        })
    }

    /// Time that stands still until it is [`set`](Self::set).
    #[cfg(target_os = "linux")]
    pub(crate) fn lockstep() -> Self {
        Self(Source::Lockstep(Arc::new(AtomicU64::new(
            0.0_f64.to_bits(),
        ))))
    }

    /// Moves a clock in lockstep on to `now`, s. Real time goes on by itself.
    #[cfg(target_os = "linux")]
    pub(crate) fn set(&self, now: f64) {
        if let Source::Lockstep(time) = &self.0 {
            time.store(now.to_bits(), Ordering::Release);
        }
    }

    /// Seconds of the rig's time since it began.
    pub fn now(&self) -> f64 {
        match &self.0 {
            Source::Real { origin, speed } => origin.elapsed().as_secs_f64() * speed,
            Source::Lockstep(time) => f64::from_bits(time.load(Ordering::Acquire)),
        }
    }

    /// How long so many `seconds` of the rig's time take; none where they are none, or where time waits for nobody's clock.
    pub fn real_time(&self, seconds: f64) -> Duration {
        let seconds = match self.0 {
            Source::Real { speed, .. } => seconds / speed,
            Source::Lockstep(_) => 0.0,
        };
        Duration::try_from_secs_f64(seconds).unwrap_or_default()
    }
}
