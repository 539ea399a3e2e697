//! A schedule that starts each step when new data has arrived, or after a timeout.

use super::clock::{Clock, Monotonic};
use super::error::PaceError;
use super::schedule::Schedule;
use super::timer::{NAP, Tick};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Maximum delay of a source, in periods, after which a step starts without its data: twice the jitter of cameras and
/// networks.
const GRACE: f64 = 0.25;
/// Minimum time between the starts of consecutive steps, in periods.
const SHORTEST: f64 = 0.5;

/// Set of data sources whose new data triggers steps.
pub trait StepTrigger {
    /// Blocks until every source has data that has not been used by a step, for at most `longest`. Returns the arrival
    /// time of the latest of that data on the schedule's clock; `None` after the timeout. A step uses all data that is
    /// available when it starts.
    fn wait_for(&mut self, longest: Duration) -> Option<Duration>;
}

/// Schedule that starts a step as soon as every source has new data, so that the loop need not wait for a clock that is
/// not synchronised with the sources. If a source is late by more than a quarter of a period, steps run without it once
/// per period; its data then becomes stale and stops the hand, as with any schedule. Steps are at least half a period
/// apart.
#[derive(Clone, Debug)]
pub struct DataDriven<A, C = Monotonic> {
    arrivals: A,
    clock: C,
    period: Duration,
    /// Number of the latest step.
    steps: u64,
    /// Start time of the latest step.
    newest: Duration,
    /// Latest start time of the next step, even if data is missing.
    latest: Duration,
}

impl<A: StepTrigger> DataDriven<A> {
    /// Creates a schedule that starts now and is triggered by `arrivals`, which are expected once per `period` (s), on
    /// the system's monotonic clock.
    ///
    /// # Errors
    /// If the period is not between 1e-6 and 3600 s.
    pub fn new(arrivals: A, period: f64) -> Result<Self, PaceError> {
        Self::with_clock(arrivals, period, Monotonic::new())
    }
}

impl<A: StepTrigger, C: Clock> DataDriven<A, C> {
    /// Like [`new`](Self::new), but on `clock`.
    ///
    /// # Errors
    /// If the period is not between 1e-6 and 3600 s.
    pub fn with_clock(arrivals: A, period: f64, clock: C) -> Result<Self, PaceError> {
        PaceError::check_period(period)?;
        let (now, period) = (clock.now(), Duration::from_secs_f64(period));
        Ok(Self {
            arrivals,
            clock,
            period,
            steps: 0,
            newest: now,
            latest: now + period.mul_f64(1.0 + GRACE),
        })
    }

    /// Waits for the next step. Returns the arrival time of the latest data that it uses, `Some(None)` if the step is
    /// due without complete data, or `None` if interrupted.
    fn wait(&mut self, interrupted: &AtomicBool) -> Option<Option<Duration>> {
        let earliest = self.newest + self.period.mul_f64(SHORTEST);
        while !interrupted.load(Ordering::Relaxed) {
            let now = self.clock.now();
            if now < earliest {
                self.clock.sleep_until(earliest.min(now + NAP));
                continue;
            }
            let left = self.latest.saturating_sub(now);
            if let Some(arrived) = self.arrivals.wait_for(left.min(NAP)) {
                return Some(Some(arrived.max(earliest)));
            }
            if self.clock.now() >= self.latest {
                return Some(None);
            }
        }
        None
    }
}

impl<A: StepTrigger, C: Clock> Schedule for DataDriven<A, C> {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        let asked = self.clock.now();
        let arrived = self.wait(interrupted)?;
        let now = self.clock.now();
        let due = arrived.unwrap_or(self.latest);
        // The nearest number of periods, because arrivals jitter.
        let periods = (now.saturating_sub(self.newest)).div_duration_f64(self.period);
        let gone = (periods.round() as u64).max(1);
        self.steps += gone;
        self.latest = match arrived {
            Some(_) => now + self.period.mul_f64(1.0 + GRACE),
            // From here on once a period, unless a step takes longer.
            None => (self.latest + self.period).max(now + self.period.mul_f64(SHORTEST)),
        };
        self.newest = now;
        Some(Tick {
            number: self.steps,
            lateness: now.saturating_sub(due).as_secs_f64(),
            missed: gone - 1,
            overran: asked > due,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::rc::Rc;

    static GO_ON: AtomicBool = AtomicBool::new(false);

    /// A clock that advances only when a thread sleeps.
    #[derive(Clone, Default)]
    struct Slept(Rc<Cell<Duration>>);

    impl Clock for Slept {
        fn now(&self) -> Duration {
            self.0.get()
        }

        fn sleep_until(&self, time: Duration) {
            self.0.set(self.0.get().max(time));
        }
    }

    /// Scheduled arrival times (ms) of each source, and the time of the latest step.
    struct Planned {
        clock: Slept,
        times: Vec<Vec<f64>>,
        stepped: Slept,
    }

    fn ms(time: f64) -> Duration {
        Duration::from_secs_f64(time * 1e-3)
    }

    impl StepTrigger for Planned {
        fn wait_for(&mut self, longest: Duration) -> Option<Duration> {
            let stepped = self.stepped.now();
            let first = |times: &Vec<f64>| times.iter().map(|&t| ms(t)).find(|&t| t > stepped);
            let firsts: Option<Vec<Duration>> = self.times.iter().map(first).collect();
            let until = self.clock.now() + longest;
            let whole = firsts.and_then(|firsts| firsts.into_iter().max());
            let whole = whole.filter(|&whole| whole <= until);
            self.clock.sleep_until(whole.unwrap_or(until));
            whole
        }
    }

    /// Start times (ms) and ticks of the first `count` steps of 10 ms, with data arriving at `times` and steps that
    /// take `busy` ms.
    fn steps(times: &[&[f64]], count: usize, busy: f64) -> Vec<(f64, Tick)> {
        let (clock, stepped) = (Slept::default(), Slept::default());
        let arrivals = Planned {
            clock: clock.clone(),
            times: times.iter().map(|times| times.to_vec()).collect(),
            stepped: stepped.clone(),
        };
        let mut following = DataDriven::with_clock(arrivals, 0.01, clock.clone()).unwrap();
        let step = |_| {
            let tick = following.next_tick(&GO_ON).expect("a step");
            let now = clock.now();
            stepped.sleep_until(now);
            clock.sleep_until(now + ms(busy));
            (now.as_secs_f64() * 1e3, tick)
        };
        (0..count).map(step).collect()
    }

    fn times(steps: &[(f64, Tick)]) -> Vec<f64> {
        let rounded = steps.iter().map(|(time, _)| (time * 1e3).round() / 1e3);
        rounded.collect()
    }

    #[test]
    fn a_step_starts_when_the_last_fingers_frame_has_arrived() {
        let made = steps(
            &[&[6.0, 16.5, 26.0, 36.0], &[7.0, 16.0, 27.5, 37.0]],
            4,
            1.0,
        );
        assert_eq!(times(&made), [7.0, 16.5, 27.5, 37.0]);
        let numbers: Vec<_> = made
            .iter()
            .map(|(_, tick)| (tick.number, tick.missed))
            .collect();
        assert_eq!(numbers, [(1, 0), (2, 0), (3, 0), (4, 0)]);
        assert!(
            made.iter()
                .all(|(_, tick)| tick.lateness < 1e-9 && !tick.overran)
        );
    }

    /// Steps run once a period with the other camera's frames, and follow both cameras again once the stalled one is
    /// back.
    #[test]
    fn a_stalled_camera_does_not_stall_the_steps() {
        let other: Vec<f64> = (0..12).map(|n| 8.0 + 10.0 * f64::from(n)).collect();
        let made = steps(&[&[8.0, 18.0, 78.0, 88.0], &other], 9, 1.0);
        let expected = [8.0, 18.0, 30.5, 40.5, 50.5, 60.5, 70.5, 78.0, 88.0];
        assert_eq!(times(&made), expected);
        assert_eq!(made[8].1.number, 9);
        assert!(made.iter().all(|(_, tick)| tick.missed == 0));
    }

    #[test]
    fn a_burst_of_frames_causes_no_burst_of_steps() {
        let made = steps(&[&[10.0, 10.1, 10.2, 20.0, 30.0]], 3, 0.1);
        // Frames that arrived in the meantime are used in one step.
        assert_eq!(times(&made), [10.0, 15.0, 20.0]);
    }

    #[test]
    fn after_an_overrun_periods_are_missed_and_the_next_step_starts_at_once() {
        let every: Vec<f64> = (1..20).map(|n| 10.0 * f64::from(n)).collect();
        let made = steps(&[&every], 3, 34.0);
        assert_eq!(times(&made), [10.0, 44.0, 78.0]);
        let (_, late) = made[1];
        assert_eq!((late.number, late.missed, late.overran), (4, 2, true));
        // The first frame used by this step arrived at 20 ms.
        assert!((late.lateness - 0.024).abs() < 1e-9, "{late:?}");
    }

    #[test]
    fn an_interrupt_ends_the_wait() {
        let clock = Slept::default();
        let arrivals = Planned {
            clock: clock.clone(),
            times: vec![vec![1.0]],
            stepped: Slept::default(),
        };
        let mut following = DataDriven::with_clock(arrivals, 0.01, clock).unwrap();
        assert_eq!(following.next_tick(&AtomicBool::new(true)), None);
    }
}
