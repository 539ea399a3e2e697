//! Schedules of control steps, in real time or as fast as possible.

use super::clock::Clock;
use super::timer::{FixedRate, Tick};
use std::sync::atomic::{AtomicBool, Ordering};

/// Determines when each step of a loop starts.
pub trait Schedule {
    /// Waits until the next step is due. Returns `None` once `interrupted` is set.
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick>;
}

impl<C: Clock> Schedule for FixedRate<C> {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        self.wait_interruptible(interrupted)
    }
}

impl<S: Schedule + ?Sized> Schedule for Box<S> {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        (**self).next_tick(interrupted)
    }
}

/// Schedule that never waits, for simulations.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreeRunning {
    steps: u64,
}

impl Schedule for FreeRunning {
    fn next_tick(&mut self, interrupted: &AtomicBool) -> Option<Tick> {
        self.steps += 1;
        (!interrupted.load(Ordering::Relaxed)).then_some(Tick::on_time(self.steps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unpaced_steps_are_counted_on_time_until_interrupted() {
        let interrupted = AtomicBool::new(false);
        let mut unpaced = FreeRunning::default();
        assert_eq!(unpaced.next_tick(&interrupted), Some(Tick::on_time(1)));
        assert_eq!(unpaced.next_tick(&interrupted), Some(Tick::on_time(2)));
        interrupted.store(true, Ordering::Relaxed);
        assert_eq!(unpaced.next_tick(&interrupted), None);
    }
}
