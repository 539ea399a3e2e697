//! The control period: deadlines, missed periods and punctuality. The tests control the clock, so they do not depend
//! on the machine's speed.

use assert_no_alloc::assert_no_alloc;
use feeler::pace::{Clock, FixedRate, Monotonic, PaceError, Punctuality, Tick};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Deadlines are rounded to the nanosecond.
const ROUNDING: f64 = 1e-9;

/// A clock that advances only in sleep, which may end late by a configured time.
#[derive(Clone, Default)]
struct TestClock(Rc<TestClockState>);

#[derive(Default)]
struct TestClockState {
    now: Cell<Duration>,
    /// Delays of the next sleeps; the last entry is used first.
    late: RefCell<Vec<Duration>>,
    sleeps: Cell<usize>,
    /// Flag that the clock raises, and the time at which it does.
    stop: AtomicBool,
    stop_at: Cell<Option<Duration>>,
}

impl TestClock {
    fn at(seconds: f64) -> Self {
        let clock = Self::default();
        clock.0.now.set(Duration::from_secs_f64(seconds));
        clock
    }

    /// Simulates a step that takes `seconds`.
    fn work(&self, seconds: f64) {
        let now = self.0.now.get() + Duration::from_secs_f64(seconds);
        self.0.now.set(now);
    }

    fn next_sleep_is_late(&self, seconds: f64) {
        let late = Duration::from_secs_f64(seconds);
        self.0.late.borrow_mut().push(late);
    }
}

impl Clock for TestClock {
    fn now(&self) -> Duration {
        self.0.now.get()
    }

    fn sleep_until(&self, time: Duration) {
        let late = self.0.late.borrow_mut().pop().unwrap_or_default();
        let now = (time + late).max(self.now());
        self.0.now.set(now);
        self.0.sleeps.set(self.0.sleeps.get() + 1);
        if self.0.stop_at.get().is_some_and(|at| now >= at) {
            self.0.stop.store(true, Ordering::Relaxed);
        }
    }
}

fn assert_close(value: f64, expected: f64) {
    assert!(
        (value - expected).abs() <= ROUNDING,
        "{value} instead of {expected}"
    );
}

#[test]
fn deadlines_are_multiples_of_the_period_regardless_of_late_steps() {
    // A third is not a whole number of nanoseconds; rounding would add up visibly.
    let period = 0.01 / 3.0;
    let clock = TestClock::at(1234.5);
    let mut pace = FixedRate::with_clock(period, clock.clone()).unwrap();
    for step in 1..=100_000_u64 {
        assert_close(pace.deadline(), step as f64 * period);
        let late = (step * 7919 % 1000) as f64 * 3e-6;
        clock.next_sleep_is_late(late);
        let tick = pace.wait();
        assert_eq!((tick.number, tick.missed, tick.overran), (step, 0, false));
        assert_close(tick.lateness, late);
        clock.work(1e-4);
    }
}

#[test]
fn wholly_missed_periods_are_counted_and_skipped() {
    let clock = TestClock::at(0.0);
    let mut pace = FixedRate::with_clock(0.01, clock.clone()).unwrap();
    clock.work(0.034);
    let tick = pace.wait();
    assert_eq!((tick.number, tick.missed, tick.overran), (3, 2, true));
    assert_close(tick.lateness, 0.024);
    assert_eq!(clock.0.sleeps.get(), 0);
    assert_close(pace.deadline(), 0.04);
    let tick = pace.wait();
    assert_eq!((tick.number, tick.missed, tick.overran), (4, 0, false));
    assert_close(tick.lateness, 0.0);
}

#[test]
fn a_long_sleep_misses_periods_without_an_overrun() {
    let clock = TestClock::at(7.0);
    let mut pace = FixedRate::with_clock(0.01, clock.clone()).unwrap();
    clock.next_sleep_is_late(0.05);
    let tick = pace.wait();
    assert_eq!((tick.number, tick.missed, tick.overran), (6, 5, false));
    assert_close(tick.lateness, 0.05);
}

#[test]
fn a_step_that_ends_in_the_next_period_is_an_overrun() {
    let clock = TestClock::at(0.0);
    let mut pace = FixedRate::with_clock(0.01, clock.clone()).unwrap();
    clock.work(0.013);
    let tick = pace.wait();
    assert_eq!((tick.number, tick.missed, tick.overran), (1, 0, true));
    assert_close(tick.lateness, 0.003);
    assert_close(pace.deadline(), 0.02);
}

#[test]
fn every_period_is_a_step_or_missed() {
    for period in [1e-6, 0.001, 0.01 / 3.0, 0.7] {
        let clock = TestClock::at(3.0e6);
        let mut pace = FixedRate::with_clock(period, clock.clone()).unwrap();
        let mut missed = 0;
        for step in 1..=10_000_u64 {
            // From zero to three periods, often exactly to a deadline.
            clock.work((step * 7919 % 13) as f64 / 4.0 * period);
            let tick = pace.wait();
            missed += tick.missed;
            assert_eq!(tick.number, step + missed, "period {period}");
            assert!(clock.now().as_secs_f64() - 3.0e6 < pace.deadline() + 1e-6);
        }
        assert!(missed > 0);
    }
}

#[test]
fn restarting_clears_the_statistics() {
    let clock = TestClock::at(0.0);
    let mut pace = FixedRate::with_clock(0.01, clock.clone()).unwrap();
    clock.work(5.005);
    pace.restart();
    let tick = pace.wait();
    assert_eq!((tick.number, tick.missed, tick.overran), (1, 0, false));
    assert_close(clock.now().as_secs_f64(), 5.015);
}

#[test]
fn a_raised_flag_ends_a_long_wait_within_one_nap() {
    let clock = TestClock::at(0.0);
    let mut pace = FixedRate::with_clock(10.0, clock.clone()).unwrap();
    clock.0.stop_at.set(Some(Duration::from_secs_f64(3.01)));
    assert_eq!(pace.wait_interruptible(&clock.0.stop), None);
    assert!(
        clock.now() <= Duration::from_millis(3060),
        "{:?}",
        clock.now()
    );
    assert_eq!(pace.wait_interruptible(&clock.0.stop), None);
}

#[test]
fn an_interruptible_wait_keeps_the_same_deadlines() {
    let clock = TestClock::at(0.0);
    let stop = AtomicBool::new(false);
    for (period, sleeps) in [(0.01, 1), (0.05, 1), (0.12, 3)] {
        let mut pace = FixedRate::with_clock(period, clock.clone()).unwrap();
        clock.0.sleeps.set(0);
        let tick = pace.wait_interruptible(&stop).unwrap();
        assert_eq!((tick.number, tick.missed, tick.overran), (1, 0, false));
        assert_close(tick.lateness, 0.0);
        assert_eq!(clock.0.sleeps.get(), sleeps, "period {period}");
    }
}

#[test]
fn unusable_periods_are_rejected() {
    for period in [0.0, -0.01, 1e-7, 3601.0, f64::NAN, f64::INFINITY] {
        let error = FixedRate::new(period).unwrap_err();
        assert!(matches!(error, PaceError::Period { .. }), "{error}");
    }
}

/// The system's clock advances and sleep does not end early; lateness is not tested.
#[test]
fn sleep_on_the_systems_clock_does_not_end_early() {
    let clock = Monotonic::new();
    let past = clock.now();
    clock.sleep_until(past);
    let mut pace = FixedRate::new(1e-3).unwrap();
    let tick = pace.wait();
    assert!(clock.now() >= past + Duration::from_millis(1));
    assert_eq!(tick.number, 1 + tick.missed);
}

#[test]
fn statistics_are_empty_before_the_first_tick() {
    let summary = Punctuality::new().unwrap().summary();
    assert_eq!((summary.steps, summary.missed, summary.overruns), (0, 0, 0));
    assert_eq!((summary.median, summary.percentile_99), (None, None));
    assert_eq!(summary.largest, None);
    assert_eq!(
        summary.to_string(),
        "0 steps; 0 periods missed, 0 steps overran"
    );
}

#[test]
fn percentiles_are_computed_from_the_ticks() {
    let mut punctuality = Punctuality::new().unwrap();
    for microseconds in 1..=1000_u32 {
        punctuality.record(&Tick {
            number: microseconds.into(),
            lateness: f64::from(microseconds) * 1e-6,
            missed: u64::from(microseconds % 100 == 0),
            overran: microseconds % 10 == 0,
        });
    }
    let summary = punctuality.summary();
    assert_eq!(summary.steps, 1000);
    assert_eq!((summary.missed, summary.overruns), (10, 100));
    // The histogram keeps two digits.
    assert!((summary.median.unwrap() / 500e-6 - 1.0).abs() <= 0.01);
    assert!((summary.percentile_99.unwrap() / 990e-6 - 1.0).abs() <= 0.01);
    assert_eq!(summary.largest, Some(1000e-6));
    assert_eq!(
        summary.to_string(),
        format!(
            "1000 steps, late by {:.0} us (median), {:.0} us (99 %), 1000 us (at most); \
             10 periods missed, 100 steps overran",
            summary.median.unwrap() * 1e6,
            summary.percentile_99.unwrap() * 1e6
        )
    );
}

#[test]
fn the_maximum_includes_lateness_beyond_the_histogram() {
    let mut punctuality = Punctuality::new().unwrap();
    punctuality.record(&Tick {
        number: 1,
        lateness: 1e5,
        missed: 0,
        overran: false,
    });
    let summary = punctuality.summary();
    assert_eq!((summary.steps, summary.largest), (1, Some(1e5)));
}

#[test]
fn a_step_on_time_does_not_allocate() {
    let mut pace = FixedRate::new(1e-6).unwrap();
    let mut punctuality = Punctuality::new().unwrap();
    let stop = AtomicBool::new(false);
    assert_no_alloc(|| {
        for _ in 0..100 {
            punctuality.record(&pace.wait());
            punctuality.record(&pace.wait_interruptible(&stop).unwrap());
        }
    });
    assert_eq!(punctuality.summary().steps, 200);
}
