//! Progress bars and spinners on standard error; hidden unless it is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::ops::Deref;
use std::time::{Duration, Instant};

/// Interval between redraws while no step completes.
const TICK: Duration = Duration::from_millis(100);

/// Number of steps of a bar that shows a fraction.
const PARTS: u64 = 1000;

/// Progress bar or spinner that is removed when dropped.
pub struct Bar(ProgressBar);

impl Bar {
    /// Creates a bar over `length` steps. `template` is its format in the notation of [`ProgressStyle`].
    pub fn new(length: u64, template: &str) -> Self {
        Self::styled(ProgressBar::new(length), template)
    }

    /// Creates a spinner. `template` is its format in the notation of [`ProgressStyle`].
    pub fn spinner(template: &str) -> Self {
        Self::styled(ProgressBar::new_spinner(), template)
    }

    fn styled(bar: ProgressBar, template: &str) -> Self {
        // With an invalid template, the default style remains.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// Sets the first message, and enables periodic redraws even if no step completes.
    fn ticking(self, message: &'static str) -> Self {
        self.set_message(message);
        self.enable_steady_tick(TICK);
        self
    }
}

impl Deref for Bar {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.0
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish_and_clear();
    }
}

/// Progress bar over a known number of steps, visible before the first one completes.
pub struct Steps(Bar);

impl Steps {
    /// Creates a bar over `steps` steps.
    pub fn new(steps: usize) -> Self {
        let bar = Bar::new(steps as u64, "{bar:32} {pos}/{len} steps, {eta} left");
        Self(bar.ticking(""))
    }

    /// Marks one more step as done.
    pub fn advance(&self) {
        self.0.inc(1);
    }

    /// Hides the bar while `print` writes lines to the terminal.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }
}

/// Progress bar for reading one file.
pub struct Reading(Bar);

impl Default for Reading {
    fn default() -> Self {
        Self::new()
    }
}

impl Reading {
    /// Creates a bar at 0 %.
    pub fn new() -> Self {
        let bar = Bar::new(PARTS, "{msg} {bar:32} {percent} %, {elapsed}");
        Self(bar.ticking("reading the recording"))
    }

    /// Shows the fraction of the file that has been read, 0 to 1.
    pub fn show(&self, share: f64) {
        self.0.set_position((share * PARTS as f64) as u64);
    }
}

/// Spinner for work of unknown duration, shown until dropped.
pub struct Working {
    _bar: Bar,
}

impl Working {
    /// Creates a spinner labelled `task`, such as `fitting`.
    pub fn on(task: &'static str) -> Self {
        let bar = Bar::spinner("{spinner} {msg}, {elapsed}");
        Self {
            _bar: bar.ticking(task),
        }
    }
}

/// Progress bar of a search with a limit on time (s), on runs, or on both.
pub struct Search {
    bar: Bar,
    start: Instant,
    seconds: Option<f64>,
    runs: Option<u64>,
}

impl Search {
    /// Creates a bar for a search limited to a duration (s), a number of runs, or both.
    pub fn new(seconds: Option<f64>, runs: Option<u64>) -> Self {
        Self {
            bar: Bar::new(PARTS, "{bar:32} {msg}, {elapsed}").ticking("simulating"),
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
