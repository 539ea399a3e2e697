//! Schedule with a fixed control period.

use super::clock::{Clock, Monotonic};
use super::error::PaceError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Maximum duration of a sleep between two checks of the flag that interrupts the wait.
pub(super) const NAP: Duration = Duration::from_millis(50);

/// A step that is due, with its timing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Number of periods since the start: 1 for the first tick if no period is missed. The step belongs to the latest
    /// deadline that has passed.
    pub number: u64,
    /// Time between the deadline and the end of the wait (s). It exceeds a period if periods were missed.
    pub lateness: f64,
    /// Number of whole periods without a step since the last tick. Missed steps are not repeated.
    pub missed: u64,
    /// `true` if the deadline had already passed when the wait began, because the previous step took too long.
    /// Otherwise any lateness is caused by the system.
    pub overran: bool,
}

impl Tick {
    /// Returns the tick of step `number` (from 1) without lateness.
    pub fn on_time(number: u64) -> Self {
        Self {
            number,
            lateness: 0.0,
            missed: 0,
            overran: false,
        }
    }
}

/// Timer with absolute deadlines at the multiples of the period since the start, independent of the lateness of steps.
#[derive(Clone, Debug)]
pub struct FixedRate<C = Monotonic> {
    clock: C,
    /// Control period (s).
    period: f64,
    start: Duration,
    /// Multiple of the period at which the next step is due.
    next: u64,
}

impl FixedRate {
    /// Creates a timer of `period` (s) that starts now, on the system's monotonic clock. The first deadline is one
    /// period from now.
    ///
    /// # Errors
    /// If the period is not between 1e-6 and 3600 s.
    pub fn new(period: f64) -> Result<Self, PaceError> {
        Self::with_clock(period, Monotonic::new())
    }
}

impl<C: Clock> FixedRate<C> {
    /// Creates a timer of `period` (s) that starts now, on `clock`.
    ///
    /// # Errors
    /// If the period is not between 1e-6 and 3600 s.
    pub fn with_clock(period: f64, clock: C) -> Result<Self, PaceError> {
        PaceError::check_period(period)?;
        let start = clock.now();
        Ok(Self {
            clock,
            period,
            start,
            next: 1,
        })
    }

    /// Time of the next deadline since the start (s).
    pub fn deadline(&self) -> f64 {
        self.since_start(self.next).as_secs_f64()
    }

    /// Restarts the timer: the next deadline is one period from now.
    pub fn restart(&mut self) {
        self.start = self.clock.now();
        self.next = 1;
    }

    /// Sleeps until the next step is due; returns immediately if it already is.
    pub fn wait(&mut self) -> Tick {
        let deadline = self.due();
        let asked = self.clock.now();
        let mut now = asked;
        while now < deadline {
            self.clock.sleep_until(deadline);
            now = self.clock.now();
        }
        self.tick(asked, now)
    }

    /// Sleeps until the next step is due. Returns `None` within 50 ms after `stop` is set.
    pub fn wait_interruptible(&mut self, stop: &AtomicBool) -> Option<Tick> {
        let deadline = self.due();
        let asked = self.clock.now();
        let mut now = asked;
        while !stop.load(Ordering::Relaxed) {
            if now >= deadline {
                return Some(self.tick(asked, now));
            }
            // A signal may wake another thread than this one, so long sleeps are split.
            self.clock.sleep_until(deadline.min(now + NAP));
            now = self.clock.now();
        }
        None
    }

    /// Time of the next deadline on the clock.
    fn due(&self) -> Duration {
        self.start + self.since_start(self.next)
    }

    /// Deadline of a multiple of the period, relative to the start. Computed as a single product, so that rounding to
    /// nanoseconds does not accumulate.
    fn since_start(&self, multiple: u64) -> Duration {
        Duration::from_secs_f64(multiple as f64 * self.period)
    }

    /// Tick of a wait that began at `asked` and ended at `now`, after the deadline.
    fn tick(&mut self, asked: Duration, now: Duration) -> Tick {
        let deadline = self.due();
        let number = self.latest(now);
        let missed = number - self.next;
        self.next = number + 1;
        Tick {
            number,
            lateness: now.saturating_sub(deadline).as_secs_f64(),
            missed,
            overran: asked > deadline,
        }
    }

    /// Latest multiple of the period whose deadline has passed at `now`, but at least the next multiple.
    fn latest(&self, now: Duration) -> u64 {
        let elapsed = now.saturating_sub(self.start);
        // Because of rounding, the quotient may be off by one at a deadline.
        let mut latest = (elapsed.as_secs_f64() / self.period) as u64;
        if self.since_start(latest) > elapsed {
            latest -= 1;
        } else if self.since_start(latest + 1) <= elapsed {
            latest += 1;
        }
        latest.max(self.next)
    }
}
