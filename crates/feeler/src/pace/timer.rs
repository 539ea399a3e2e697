//! Waits for the multiples of the control period.

use super::clock::{Clock, Monotonic};
use super::error::PaceError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The longest sleep between two looks at whether to stop.
pub(super) const NAP: Duration = Duration::from_millis(50);

/// A step that is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// How many periods have gone by since the start: 1 for the first tick when nothing is missed. The
    /// step is that of the latest deadline that has come.
    pub number: u64,
    /// How long after the deadline that was waited for the wait ended, s. With missed periods, more than
    /// a period.
    pub lateness: f64,
    /// Periods since the last tick that went by whole without a step. They are not made up for.
    pub missed: u64,
    /// Whether the deadline had passed when the wait began: the step before took longer than there was
    /// time. Otherwise any lateness is the system's.
    pub overran: bool,
}

impl Tick {
    /// The tick of step `number`, from 1, that begins on time.
    pub fn on_time(number: u64) -> Self {
        Self {
            number,
            lateness: 0.0,
            missed: 0,
            overran: false,
        }
    }
}

/// An absolute timer: deadlines are the multiples of a period since its start, however late a step was.
#[derive(Clone, Debug)]
pub struct Pace<C = Monotonic> {
    clock: C,
    /// s.
    period: f64,
    start: Duration,
    /// Which multiple of the period is due next.
    next: u64,
}

impl Pace {
    /// A pace of `period` (s) that starts now, on the system's monotonic clock. The first deadline is a
    /// period away.
    ///
    /// # Errors
    /// When the period is not between 1e-6 and 3600 s.
    pub fn new(period: f64) -> Result<Self, PaceError> {
        Self::with_clock(period, Monotonic::new())
    }
}

impl<C: Clock> Pace<C> {
    /// A pace of `period` (s) that starts now, on `clock`.
    ///
    /// # Errors
    /// When the period is not between 1e-6 and 3600 s.
    pub fn with_clock(period: f64, clock: C) -> Result<Self, PaceError> {
        if !(1e-6..=3600.0).contains(&period) {
            return Err(PaceError::Period { period });
        }
        let start = clock.now();
        Ok(Self {
            clock,
            period,
            start,
            next: 1,
        })
    }

    /// The period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// When the next step is due, s since the start.
    pub fn deadline(&self) -> f64 {
        self.since_start(self.next).as_secs_f64()
    }

    /// Starts again: the next deadline is a period from now.
    pub fn restart(&mut self) {
        self.start = self.clock.now();
        self.next = 1;
    }

    /// Sleeps until the next step is due; returns at once when it already is.
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

    /// Sleeps until the next step is due, or for at most 50 ms after `stop` is raised: then none is due any
    /// more.
    pub fn wait_unless(&mut self, stop: &AtomicBool) -> Option<Tick> {
        let deadline = self.due();
        let asked = self.clock.now();
        let mut now = asked;
        while !stop.load(Ordering::Relaxed) {
            if now >= deadline {
                return Some(self.tick(asked, now));
            }
            // A signal may wake another thread than this one, so a long sleep is taken in naps.
            self.clock.sleep_until(deadline.min(now + NAP));
            now = self.clock.now();
        }
        None
    }

    /// The next deadline on the clock.
    fn due(&self) -> Duration {
        self.start + self.since_start(self.next)
    }

    /// The deadline of a multiple of the period, from the start. It is made by one product, so that what a
    /// nanosecond cannot express does not add up.
    fn since_start(&self, multiple: u64) -> Duration {
        Duration::from_secs_f64(multiple as f64 * self.period)
    }

    /// The tick of a wait that began at `asked` and ended at `now`, past the deadline.
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

    /// The last multiple of the period whose deadline is not after `now`; at least the next.
    fn latest(&self, now: Duration) -> u64 {
        let elapsed = now.saturating_sub(self.start);
        // The quotient is rounded, which may be one off at a deadline.
        let mut latest = (elapsed.as_secs_f64() / self.period) as u64;
        if self.since_start(latest) > elapsed {
            latest -= 1;
        } else if self.since_start(latest + 1) <= elapsed {
            latest += 1;
        }
        latest.max(self.next)
    }
}
