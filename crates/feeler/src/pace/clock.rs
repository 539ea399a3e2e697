//! Clocks for schedules.

use std::time::Duration;

/// A monotonic clock that can sleep until a given time.
pub trait Clock {
    /// Time since the clock's origin.
    fn now(&self) -> Duration;

    /// Sleeps until the clock reaches `time`. May return early, so callers must check the clock again.
    fn sleep_until(&self, time: Duration);
}

/// The system's monotonic clock. It is never adjusted, and does not advance while the system is suspended.
#[cfg(target_os = "linux")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Monotonic;

#[cfg(target_os = "linux")]
impl Monotonic {
    /// Creates a handle to the clock.
    pub fn new() -> Self {
        Self
    }
}

#[cfg(target_os = "linux")]
impl Clock for Monotonic {
    fn now(&self) -> Duration {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        // Time since the system started, so never negative.
        now.try_into().unwrap_or_default()
    }

    fn sleep_until(&self, time: Duration) {
        let Ok(time) = rustix::time::Timespec::try_from(time) else {
            return;
        };
        // The time is absolute, so no delay between reading the clock and going to sleep adds up. A signal wakes the
        // thread early, as the trait allows.
        let _ = rustix::thread::clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &time);
    }
}

/// The standard library's clock, for systems that cannot sleep until an absolute time.
#[cfg(not(target_os = "linux"))]
#[derive(Clone, Copy, Debug)]
pub struct Monotonic {
    origin: std::time::Instant,
}

#[cfg(not(target_os = "linux"))]
impl Monotonic {
    /// Creates a clock whose origin is now.
    pub fn new() -> Self {
        let origin = std::time::Instant::now();
        Self { origin }
    }
}

#[cfg(not(target_os = "linux"))]
impl Default for Monotonic {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(not(target_os = "linux"))]
impl Clock for Monotonic {
    fn now(&self) -> Duration {
        self.origin.elapsed()
    }

    fn sleep_until(&self, time: Duration) {
        std::thread::sleep(time.saturating_sub(self.now()));
    }
}
