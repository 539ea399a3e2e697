//! Progress bar of a simulated run.

use feeler::control::Phase;
use feeler_console::Bar;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::SimulatedLoop;
use std::time::{Duration, Instant};

/// A progress bar over the run's strokes.
pub struct Progress {
    bar: Bar,
    start: Instant,
    shown: Instant,
}

impl Progress {
    /// Minimum time between two redraws.
    const INTERVAL: Duration = Duration::from_millis(50);
    const PHASES_PER_STROKE: u64 = 4;

    /// A bar for a run of `experiment`; hidden unless standard error is a terminal.
    pub fn new(experiment: &Experiment) -> Self {
        let strokes = u64::from(experiment.config.task.strokes());
        let start = Instant::now();
        Self {
            bar: Bar::new(strokes * Self::PHASES_PER_STROKE, "{bar:32} {msg}"),
            start,
            shown: start,
        }
    }

    /// Shows the run's stroke, phase and speed.
    pub fn show(&mut self, control_loop: &SimulatedLoop) {
        let now = Instant::now();
        if now - self.shown < Self::INTERVAL {
            return;
        }
        self.shown = now;
        let controller = control_loop.controller();
        let (stroke, phase) = (controller.task().stroke(), controller.phase());
        let sim_time = control_loop.state().stamp;
        let strokes_done = u64::from(stroke.saturating_sub(1));
        let phases_done = match phase {
            Phase::Search => 0,
            Phase::Move => 1,
            Phase::Release => 2,
            Phase::Return => 3,
            Phase::Done | Phase::Stopped => 4,
        };
        self.bar
            .set_position(strokes_done * Self::PHASES_PER_STROKE + phases_done);
        self.bar.set_message(format!(
            "{sim_time:5.1} s simulated, stroke {stroke} {phase}, {:.0} x real time",
            sim_time / (now - self.start).as_secs_f64()
        ));
    }

    /// Removes the bar from the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
