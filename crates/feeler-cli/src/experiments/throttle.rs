//! Pacing of simulated time.

use feeler::pace::{Schedule, Tick};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Value of `--speed` that selects the maximum speed.
const FASTEST: &str = "max";
/// Lateness beyond which the schedule is shifted instead of catching up.
const FORGIVEN: Duration = Duration::from_millis(100);
/// Lateness that is not counted as an overrun, because the system's timer can cause it.
const TIMER_SLACK: Duration = Duration::from_millis(1);
/// Maximum delay in reacting to an interrupt.
const PATIENCE: Duration = Duration::from_millis(20);

/// Parses a `--speed` value: simulated seconds per real second, infinite for `max`.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    if text == FASTEST {
        return Ok(f64::INFINITY);
    }
    let speed: Option<f64> = text.parse().ok();
    speed
        .filter(|speed| (1e-3..=1e6).contains(speed))
        .ok_or_else(|| format!("expected a number from 0.001 to 1000000, or {FASTEST}"))
}

/// Schedule of a run's steps.
pub enum Timing {
    /// Paces simulated time. A step that is late by more than 100 ms delays all later ones.
    Held(Throttle),
    /// A schedule that does not shift after late steps, and `true` if it follows real time.
    Kept(Box<dyn Schedule>, bool),
}

impl Timing {
    /// Returns `true` if steps are tied to real time.
    pub fn is_paced(&self) -> bool {
        match self {
            Self::Held(throttle) => throttle.is_paced(),
            Self::Kept(_, is_paced) => *is_paced,
        }
    }
}

impl Schedule for Timing {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        match self {
            Self::Held(throttle) => throttle.next_tick(interrupted),
            Self::Kept(schedule, _) => schedule.next_tick(interrupted),
        }
    }
}

/// Delays each step until it is due.
pub struct Throttle {
    /// Real time per step, or `None` to run as fast as possible.
    period: Option<Duration>,
    due: Instant,
    steps: u64,
}

impl Throttle {
    /// Creates a throttle for steps of `period` simulated seconds at `speed`. The first step is due immediately.
    pub fn new(period: f64, speed: f64) -> Self {
        let period = Duration::try_from_secs_f64(period / speed);
        Self {
            period: period.ok().filter(|period| !period.is_zero()),
            due: Instant::now(),
            steps: 0,
        }
    }

    /// Returns `true` if steps are delayed at all.
    pub fn is_paced(&self) -> bool {
        self.period.is_some()
    }

    /// Waits until the next step is due or `interrupted` is set; returns the lateness.
    fn wait(&mut self, period: Duration, interrupted: &AtomicBool) -> Duration {
        let mut now = Instant::now();
        while now < self.due && !interrupted.load(Ordering::Relaxed) {
            thread::sleep((self.due - now).min(PATIENCE));
            now = Instant::now();
        }
        let behind = now.saturating_duration_since(self.due);
        self.due = if behind > FORGIVEN { now } else { self.due } + period;
        behind
    }
}

impl Schedule for Throttle {
    /// Waits for the next step. A step is marked as an overrun if it starts after the next one was due.
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        self.steps += 1;
        let mut tick = Tick::on_time(self.steps);
        if let Some(period) = self.period {
            let behind = self.wait(period, interrupted);
            tick.lateness = behind.as_secs_f64();
            tick.overran = behind > period.max(TIMER_SLACK);
        }
        (!interrupted.load(Ordering::Relaxed)).then_some(tick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_is_a_number_or_max() {
        assert_eq!(parse_speed("1"), Ok(1.0));
        assert_eq!(parse_speed("0.25"), Ok(0.25));
        assert_eq!(parse_speed("max"), Ok(f64::INFINITY));
        for wrong in ["", "0", "-1", "nan", "inf", "1e9", "fast"] {
            let error = parse_speed(wrong).unwrap_err();
            assert!(error.contains("expected a number"), "{error}");
        }
    }

    #[test]
    fn steps_take_their_real_time() {
        let interrupted = AtomicBool::new(false);
        let mut throttle = Throttle::new(0.01, 10.0);
        let start = Instant::now();
        for step in 1..=21 {
            let tick = throttle.next_tick(&interrupted).expect("a step");
            assert_eq!(tick.number, step);
        }
        assert!(start.elapsed() >= Duration::from_millis(20));
        assert!(throttle.is_paced());
    }

    #[test]
    fn an_interrupt_ends_the_wait_and_full_speed_has_none() {
        let mut throttle = Throttle::new(0.01, 1e-3);
        let interrupted = AtomicBool::new(true);
        assert_eq!(throttle.next_tick(&interrupted), None);
        assert_eq!(throttle.next_tick(&interrupted), None);
        let mut fastest = Throttle::new(0.01, f64::INFINITY);
        let tick = fastest.next_tick(&AtomicBool::new(false));
        assert_eq!(tick, Some(Tick::on_time(1)));
        assert!(!fastest.is_paced());
    }
}
