//! Progress bars on a terminal.

use feeler::control::phase::Phase;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::SimulatedLoop;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Progress bar of a run, in strokes.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    shown: Instant,
}

impl Progress {
    /// Minimum time between two updates.
    const INTERVAL: Duration = Duration::from_millis(50);
    const PHASES_PER_STROKE: u64 = 4;

    /// Creates a bar for a run of `experiment`; hidden unless standard error is a terminal.
    pub fn new(experiment: &Experiment) -> Self {
        let strokes = u64::from(experiment.config.task.strokes());
        let bar = ProgressBar::new(strokes * Self::PHASES_PER_STROKE);
        let style = ProgressStyle::with_template("{bar:32} {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let start = Instant::now();
        Self {
            bar,
            start,
            shown: start,
        }
    }

    /// Shows the progress of the run.
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

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Interval at which a bar is animated while waiting for the next step.
const TICK: Duration = Duration::from_millis(100);

/// Progress bar over steps. Visible immediately, because the first step may take long.
pub struct Steps {
    bar: ProgressBar,
}

impl Steps {
    /// Creates a bar over `steps`; hidden unless standard error is a terminal.
    pub fn new(steps: usize) -> Self {
        let bar = ProgressBar::new(steps as u64);
        let style = ProgressStyle::with_template("{bar:32} {pos}/{len} steps, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(TICK);
        Self { bar }
    }

    /// Advances the bar by one step.
    pub fn advance(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Progress bar for reading a file.
pub struct Reading(ProgressBar);

/// Resolution of a bar over a continuous quantity.
const PARTS: u64 = 1000;

impl Reading {
    /// Creates a bar; hidden unless standard error is a terminal.
    pub fn new() -> Self {
        let bar = ProgressBar::new(PARTS);
        let style = ProgressStyle::with_template("{msg} {bar:32} {percent} %, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message("reading the recording");
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    /// Shows that the fraction `share` (0 to 1) of the file has been read.
    pub fn show(&self, share: f64) {
        self.0.set_position((share * PARTS as f64) as u64);
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Spinner for work of unknown duration, removed when dropped.
pub struct Working(ProgressBar);

impl Working {
    /// Shows the activity `what`, e.g. `fitting`; hidden unless standard error is a terminal.
    pub fn on(what: &'static str) -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.set_message(what);
        bar.enable_steady_tick(TICK);
        Self(bar)
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Progress bar of a search with a budget of time, of runs, or of both.
pub struct Search {
    bar: ProgressBar,
    start: Instant,
    seconds: Option<f64>,
    runs: Option<u64>,
}

impl Search {
    /// Creates a bar over the budget; hidden unless standard error is a terminal.
    pub fn new(seconds: Option<f64>, runs: Option<u64>) -> Self {
        let bar = ProgressBar::new(PARTS);
        let style = ProgressStyle::with_template("{bar:32} {msg}, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message("simulating");
        bar.enable_steady_tick(TICK);
        Self {
            bar,
            start: Instant::now(),
            seconds,
            runs,
        }
    }

    /// Shows the number of finished runs and the best score.
    pub fn show(&self, finished: u64, score: f64) {
        let elapsed = self.start.elapsed().as_secs_f64();
        let time = self.seconds.map_or(0.0, |seconds| elapsed / seconds);
        let runs = self.runs.map_or(0.0, |runs| finished as f64 / runs as f64);
        let part = PARTS as f64 * time.max(runs).min(1.0);
        self.bar.set_position(part as u64);
        self.bar
            .set_message(format!("{finished} runs, score {score:.2}"));
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
