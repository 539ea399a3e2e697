//! Progress bars and spinners on standard error; hidden unless it is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Interval between redraws while no step completes.
const TICK: Duration = Duration::from_millis(100);

/// Progress bar over a known number of steps, visible before the first one completes.
pub struct Steps {
    bar: ProgressBar,
}

impl Steps {
    /// Creates a bar over `steps` steps.
    pub fn new(steps: usize) -> Self {
        let bar = ProgressBar::new(steps as u64);
        let style = ProgressStyle::with_template("{bar:32} {pos}/{len} steps, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(TICK);
        Self { bar }
    }

    /// Marks one more step as done.
    pub fn advance(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Progress bar over the reading of one file.
pub struct Reading(ProgressBar);

/// Resolution of a bar over a share.
const PARTS: u64 = 1000;

impl Default for Reading {
    fn default() -> Self {
        Self::new()
    }
}

impl Reading {
    /// Creates a bar at 0 %.
    pub fn new() -> Self {
        let bar = ProgressBar::new(PARTS);
        let style = ProgressStyle::with_template("{msg} {bar:32} {percent} %, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message("reading the recording");
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    /// Shows the `share` of the file read so far, 0 to 1.
    pub fn show(&self, share: f64) {
        self.0.set_position((share * PARTS as f64) as u64);
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Spinner for work of unknown duration, shown until dropped.
pub struct Working(ProgressBar);

impl Working {
    /// Creates a spinner labelled `task`, such as `fitting`.
    pub fn on(task: &'static str) -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.set_message(task);
        bar.enable_steady_tick(TICK);
        Self(bar)
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Progress bar of a search with a limit on time (s), on runs, or on both.
pub struct Search {
    bar: ProgressBar,
    start: Instant,
    seconds: Option<f64>,
    runs: Option<u64>,
}

impl Search {
    /// Creates a bar over the limits.
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

    /// Shows the number of `finished` runs and the best `score`.
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
