//! Example of a custom hand, and the loop's reaction to missed periods.

#[allow(dead_code, reason = "its main is the example's")]
#[path = "../../examples/own_hand.rs"]
mod example;

use feeler::control::{Phase, StopReason};
use feeler::hand::HandCommand;
use feeler::pace::{Clock, FixedRate};
use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

#[test]
fn the_example_touches_the_wall_and_returns() {
    let (phase, force) = example::touch_and_stroke().expect("a run");
    assert_eq!(phase, Phase::Done);
    // It moves on at 0.5 N, and presses no deeper than it moves in the steps until it has turned.
    assert!((0.5..1.0).contains(&force), "{force} N");
}

/// A clock whose `late`-th sleep ends `by` milliseconds late.
struct Oversleeping {
    now: Cell<Duration>,
    sleeps: Cell<u32>,
    late: u32,
    by: u64,
}

impl Clock for Oversleeping {
    fn now(&self) -> Duration {
        self.now.get()
    }

    fn sleep_until(&self, time: Duration) {
        self.sleeps.set(self.sleeps.get() + 1);
        let by = if self.sleeps.get() == self.late {
            self.by
        } else {
            0
        };
        self.now.set(time + Duration::from_millis(by));
    }
}

/// Runs ten steps, the fifth of them `by` milliseconds late. Returns the reason of a stop, and whether the hand moved
/// in the last step.
fn ten_steps(by: u64) -> (Option<StopReason>, bool) {
    let clock = Oversleeping {
        now: Cell::default(),
        sleeps: Cell::new(0),
        late: 5,
        by,
    };
    let mut pace = FixedRate::with_clock(0.01, clock).expect("a pace");
    let mut control_loop = example::control_loop().expect("a loop");
    let (mut steps, mut moved) = (0, false);
    let interrupted = AtomicBool::new(false);
    let ended = control_loop.run(&mut pace, 2, &interrupted, |after, _| {
        steps += 1;
        moved = *after.command() != HandCommand::stop(1);
        match steps {
            10 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    assert!(ended.is_ok() && steps == 10, "{ended:?}");
    assert_eq!(*control_loop.command(), HandCommand::stop(1));
    (control_loop.controller().stop_reason().cloned(), moved)
}

#[test]
fn too_many_missed_periods_stop_the_hand() {
    assert_eq!(ten_steps(0), (None, true));
    // Two periods are missed, the maximum allowed.
    assert_eq!(ten_steps(25), (None, true));
    let reason = StopReason::MissedPeriods {
        missed: 3,
        limit: 2,
    };
    assert_eq!(ten_steps(35), (Some(reason), false));
}
