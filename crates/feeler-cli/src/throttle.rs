//! Simulated time at a speed that one can watch.

use feeler::pace::{Schedule, Tick};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// What `--speed` says for as fast as possible.
const FASTEST: &str = "max";
/// A step that begins this much too late is not made up for by hurrying afterwards.
const FORGIVEN: Duration = Duration::from_millis(100);
/// A step is not called late when the system's timer can be the cause.
const TIMER_SLACK: Duration = Duration::from_millis(1);
/// An interrupt is seen this soon.
const PATIENCE: Duration = Duration::from_millis(20);

/// A speed as the command line says it: simulated seconds in a real second, infinite for `max`.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    if text == FASTEST {
        return Ok(f64::INFINITY);
    }
    let speed: Option<f64> = text.parse().ok();
    speed
        .filter(|speed| (1e-3..=1e6).contains(speed))
        .ok_or_else(|| format!("a number from 0.001 to 1000000 expected, or {FASTEST}"))
}

/// When the steps of a run begin.
pub enum Timing {
    /// Simulated time waits for its steps.
    Held(Throttle),
    /// Time goes on, and who misses a step has missed it; whether it is real time.
    Kept(Box<dyn Schedule>, bool),
}

impl Timing {
    /// Whether steps have real times.
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

/// Holds steps back until they are due.
pub struct Throttle {
    /// Real time of a step; nothing for as fast as possible.
    period: Option<Duration>,
    due: Instant,
    steps: u64,
}

impl Throttle {
    /// For steps of `period` simulated seconds at `speed`; the first is due now.
    pub fn new(period: f64, speed: f64) -> Self {
        let period = Duration::try_from_secs_f64(period / speed);
        Self {
            period: period.ok().filter(|period| !period.is_zero()),
            due: Instant::now(),
            steps: 0,
        }
    }

    /// Whether steps are held back at all.
    pub fn is_paced(&self) -> bool {
        self.period.is_some()
    }

    /// Waits until the next step is due, or `interrupted` is raised; how late it is then.
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
    /// A step that begins later than the next one was due overran.
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
            let said = parse_speed(wrong).unwrap_err();
            assert!(said.contains("expected, or max"), "{said}");
        }
    }

    #[test]
    fn steps_take_their_real_time() {
        let go_on = AtomicBool::new(false);
        let mut throttle = Throttle::new(0.01, 10.0);
        let start = Instant::now();
        for step in 1..=21 {
            let tick = throttle.next_tick(&go_on).expect("a step");
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
