//! What a person who loads a fingertip is told: a few lines on a terminal; elsewhere a line for each step that is done.

use feeler::sensor::live_calibration::{Delay, Stage};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write as _, stderr};
use std::time::{Duration, Instant};

/// Redrawn this often at most.
const INTERVAL: Duration = Duration::from_millis(100);
/// A warning is shown for so long.
const WARNED: Duration = Duration::from_secs(3);

pub struct Screen {
    bar: ProgressBar,
    on_terminal: bool,
    drawn: Instant,
    /// The stage that was said last.
    stage: Option<&'static str>,
    warning: Option<(String, Instant)>,
}

impl Screen {
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        Self {
            bar,
            on_terminal: stderr().is_terminal(),
            drawn: Instant::now(),
            stage: None,
            warning: None,
        }
    }

    /// Says that a step is done, where there is no terminal.
    pub fn step(&self, words: &str) {
        if !self.on_terminal {
            say(words);
        }
    }

    /// Says that something is wrong which may pass.
    pub fn warn(&mut self, what: &str) {
        let is_new = self.warning.as_ref().is_none_or(|(said, _)| said != what);
        if is_new {
            self.step(&format!("warning: {what}"));
        }
        self.warning = Some((what.to_string(), Instant::now()));
    }

    /// Says that a stage begins, in these words.
    pub fn stage(&mut self, stage: Stage, words: &'static str, delay: Option<Delay>) {
        if self.stage == Some(words) {
            return;
        }
        self.stage = Some(words);
        self.step(words);
        if let (Stage::Loads, Some(delay)) = (stage, delay) {
            self.step(&format!("the camera is {:.0} ms late", 1e3 * delay.seconds));
        }
    }

    /// Whether it is time to draw.
    pub fn is_due(&mut self) -> bool {
        let due = self.on_terminal && self.drawn.elapsed() >= INTERVAL;
        if due {
            self.drawn = Instant::now();
        }
        due
    }

    /// Draws some lines.
    pub fn draw(&self, mut lines: String) {
        if let Some((warning, at)) = &self.warning
            && at.elapsed() < WARNED
        {
            lines.push_str(&format!("warning: {warning}\n"));
        }
        self.bar.set_message(lines);
    }

    /// Takes it off the screen.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// What is missing before loads are taken; none once they are.
pub fn missing_before_loads(stage: Stage) -> Option<String> {
    match stage {
        Stage::Untouched { missing } => Some(format!("{missing} more pictures")),
        Stage::Presses {
            found: Some(delay), ..
        } => Some(format!(
            "pictures and forces do not go together well (correlation {:.2}, 0.9 expected): press slower",
            delay.correlation
        )),
        Stage::Presses { missing, .. } => Some(format!("{missing} more presses")),
        Stage::Loads => None,
    }
}

fn say(words: &str) {
    // Standard error that is closed is no reason to stop.
    let _ = writeln!(stderr(), "{words}");
}
