//! Display for the operator: a few lines that are updated on a terminal, otherwise one line per completed step.

use feeler::sensor::calibration::{Delay, Stage};
use feeler_console::Bar;
use std::io::{IsTerminal, Write as _, stderr};
use std::time::{Duration, Instant};

/// Minimum time between two updates.
const INTERVAL: Duration = Duration::from_millis(100);
/// Duration for which a warning is shown.
const WARNED: Duration = Duration::from_secs(3);

pub struct Screen {
    bar: Bar,
    on_terminal: bool,
    drawn: Instant,
    /// Stage that was announced last.
    stage: Option<&'static str>,
    warning: Option<(String, Instant)>,
}

impl Screen {
    pub fn new() -> Self {
        Self {
            bar: Bar::spinner("{msg}"),
            on_terminal: stderr().is_terminal(),
            drawn: Instant::now(),
            stage: None,
            warning: None,
        }
    }

    /// Prints a completed step if standard error is not a terminal.
    pub fn step(&self, words: &str) {
        if !self.on_terminal {
            say(words);
        }
    }

    /// Shows a warning about a condition that may be temporary.
    pub fn warn(&mut self, what: &str) {
        let is_new = self.warning.as_ref().is_none_or(|(said, _)| said != what);
        if is_new {
            self.step(&format!("warning: {what}"));
        }
        self.warning = Some((what.to_string(), Instant::now()));
    }

    /// Announces the start of a stage.
    pub fn stage(&mut self, stage: Stage, words: &'static str, delay: Option<Delay>) {
        if self.stage == Some(words) {
            return;
        }
        self.stage = Some(words);
        self.step(words);
        if let (Stage::Loads, Some(delay)) = (stage, delay) {
            self.step(&format!("camera latency: {:.0} ms", 1e3 * delay.seconds));
        }
    }

    /// Returns `true` if the display is due for an update.
    pub fn is_due(&mut self) -> bool {
        let due = self.on_terminal && self.drawn.elapsed() >= INTERVAL;
        if due {
            self.drawn = Instant::now();
        }
        due
    }

    /// Draws `lines`, and the latest warning if it is recent.
    pub fn draw(&self, mut lines: String) {
        if let Some((warning, at)) = &self.warning
            && at.elapsed() < WARNED
        {
            lines.push_str(&format!("warning: {warning}\n"));
        }
        self.bar.set_message(lines);
    }

    /// Clears the display.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// Describes the step that is missing before loading can start, or returns `None` if loading has started.
pub fn missing_before_loads(stage: Stage) -> Option<String> {
    match stage {
        Stage::Untouched { missing } => Some(format!("{missing} more images")),
        Stage::Presses {
            found: Some(delay), ..
        } => Some(format!(
            "images and forces correlate poorly (expected at least 0.9, got {:.2}); press more slowly",
            delay.correlation
        )),
        Stage::Presses { missing, .. } => Some(format!("{missing} more presses")),
        Stage::Loads => None,
    }
}

fn say(words: &str) {
    // A closed standard error is not a reason to stop.
    let _ = writeln!(stderr(), "{words}");
}
