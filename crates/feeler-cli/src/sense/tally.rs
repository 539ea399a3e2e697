//! Counts what was sensed and what was not, and says so on standard error.

use super::beside::{Beside, INTERVAL};
use feeler::sensor::exposure::Exposure;
use feeler::sensor::sensing::ElementReading;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Elements that are named in one warning at most.
const NAMED: usize = 12;

/// What came of the frames so far.
pub struct Tally {
    beside: Beside,
    shown: Instant,
    start: Instant,
    frames: u64,
    skipped: u64,
    dropped: u64,
    /// The number that the next frame should have.
    expected: Option<u64>,
    /// How old the newest frame was when it was written.
    age: Duration,
    black: Uniform,
    white: Uniform,
    dark: BTreeMap<usize, u64>,
    saturated: BTreeMap<usize, u64>,
}

/// Frames that are the same all over.
#[derive(Default)]
struct Uniform {
    count: u64,
    first: u64,
}

impl Uniform {
    fn add(&mut self, sequence: u64) {
        if self.count == 0 {
            self.first = sequence;
        }
        self.count += 1;
    }
}

impl Tally {
    /// Nothing yet. What it says waits for the terminal, or, where somebody waits for what is sensed, not.
    pub fn new(waits: bool) -> Self {
        let now = Instant::now();
        Self {
            beside: Beside::new(waits),
            shown: now,
            start: now,
            frames: 0,
            skipped: 0,
            dropped: 0,
            expected: None,
            age: Duration::ZERO,
            black: Uniform::default(),
            white: Uniform::default(),
            dark: BTreeMap::new(),
            saturated: BTreeMap::new(),
        }
    }

    /// Frames that were sensed.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Pictures that were skipped.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Counts a frame that came in at `at`.
    pub fn frame(&mut self, sequence: u64, at: Instant, readings: &[ElementReading]) {
        self.dropped += self.expected.map_or(0, |e| sequence.saturating_sub(e));
        self.expected = Some(sequence.saturating_add(1));
        self.frames += 1;
        self.age = at.elapsed();
        self.look_at(sequence, readings);
        if self.shown.elapsed() >= INTERVAL {
            self.shown = Instant::now();
            self.beside.progress(self.line());
        }
    }

    fn look_at(&mut self, sequence: u64, readings: &[ElementReading]) {
        let all = |exposure| readings.iter().all(|r| r.exposure == exposure);
        match readings.first().map(|r| r.exposure) {
            Some(Exposure::Dark) if all(Exposure::Dark) => return self.black.add(sequence),
            Some(Exposure::Saturated) if all(Exposure::Saturated) => {
                return self.white.add(sequence);
            }
            _ => {}
        }
        for (element, reading) in readings.iter().enumerate() {
            match reading.exposure {
                Exposure::Good => {}
                Exposure::Dark => *self.dark.entry(element).or_default() += 1,
                Exposure::Saturated => *self.saturated.entry(element).or_default() += 1,
            }
        }
    }

    /// Counts and names a picture that is skipped. Its number is not called dropped.
    pub fn skip(&mut self, reason: &str) {
        self.skipped += 1;
        self.expected = self.expected.map(|expected| expected.saturating_add(1));
        self.warn(&format!("skipped: {reason}"));
    }

    /// Says something that is not as it should be.
    pub fn warn(&self, warning: &str) {
        self.beside.say(&format!("warning: {warning}"));
    }

    /// The same as [`warn`](Self::warn), for somebody else to call.
    pub fn warner(&self) -> Box<dyn FnMut(&str) + Send> {
        let mut say = self.beside.sayer();
        Box::new(move |warning| say(&format!("warning: {warning}")))
    }

    /// Takes the progress off the screen and says how it went.
    pub fn close(&self) {
        self.beside.clear();
        let uniform = [(&self.black, "black"), (&self.white, "white")];
        for (uniform, colour) in uniform.into_iter().filter(|(u, _)| u.count > 0) {
            let first = uniform.first;
            let frames = frames(uniform.count);
            self.warn(&format!(
                "{frames} all {colour}, the first of them frame {first}; no forces"
            ));
        }
        let lit = [(&self.dark, "dark"), (&self.saturated, "saturated")];
        for (elements, how) in lit.into_iter().filter(|(e, _)| !e.is_empty()) {
            let names = named(elements);
            self.warn(&format!("sub-regions {how}, no force there: {names}"));
        }
        self.beside.say(&self.line());
    }

    fn line(&self) -> String {
        let seconds = self.start.elapsed().as_secs_f64();
        format!(
            "{} sensed in {seconds:.2} s, {:.1} frames/s; {} skipped, {} dropped; the newest was {:.1} ms old",
            frames(self.frames),
            self.frames as f64 / seconds.max(1e-9),
            self.skipped,
            self.dropped,
            self.age.as_secs_f64() * 1e3,
        )
    }
}

fn frames(count: u64) -> String {
    let s = if count == 1 { "" } else { "s" };
    format!("{count} frame{s}")
}

fn named(elements: &BTreeMap<usize, u64>) -> String {
    let name = |(element, &count): (&usize, &u64)| format!("element {element} ({})", frames(count));
    let mut names: Vec<_> = elements.iter().take(NAMED).map(name).collect();
    if elements.len() > NAMED {
        names.push(format!("and {} more elements", elements.len() - NAMED));
    }
    names.join(", ")
}
