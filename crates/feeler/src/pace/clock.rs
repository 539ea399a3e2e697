//! The clock that a pace is kept by.

use std::time::Duration;

/// A clock that only goes forward, and sleep until it shows a time.
pub trait Clock {
    /// Time since an origin of the clock's own.
    fn now(&self) -> Duration;

    /// Sleeps until the clock shows `time`. It may return early: who calls looks at the clock again.
    fn sleep_until(&self, time: Duration);
}

/// The system's monotonic clock. It is not set, and stands still while the system is suspended.
#[cfg(target_os = "linux")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Monotonic;

#[cfg(target_os = "linux")]
impl Monotonic {
    /// The clock.
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
        // The time is absolute: nothing is lost between reading the clock and falling asleep. A signal
        // wakes early, as the trait allows.
        let _ = rustix::thread::clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &time);
    }
}

/// The standard library's clock, on systems without sleep until an absolute time.
#[cfg(not(target_os = "linux"))]
#[derive(Clone, Copy, Debug)]
pub struct Monotonic {
    origin: std::time::Instant,
}

#[cfg(not(target_os = "linux"))]
impl Monotonic {
    /// The clock, its origin now.
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
