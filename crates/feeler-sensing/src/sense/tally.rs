//! Counts processed, skipped and dropped frames, and reports them on standard error.

use super::beside::{ConsoleReporter, INTERVAL};
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::Exposure;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Maximum number of elements named in one warning.
const NAMED: usize = 12;

/// Statistics of the frames so far.
pub struct SensingStats {
    beside: ConsoleReporter,
    shown: Instant,
    start: Instant,
    frames: u64,
    skipped: u64,
    /// Reason why the first skipped image was skipped.
    first_skipped: Option<String>,
    dropped: u64,
    /// Expected number of the next frame.
    expected: Option<u64>,
    /// Age of the latest frame when it was written.
    age: Duration,
    black: Uniform,
    white: Uniform,
    same: Uniform,
    /// Readings of the latest image.
    seen: Vec<ElementReading>,
    dark: BTreeMap<usize, u64>,
    saturated: BTreeMap<usize, u64>,
}

/// Number of frames of one kind, such as black frames, and the first of them.
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

impl SensingStats {
    /// Creates empty statistics. If `waits` is `false`, messages are printed by background threads and never block.
    pub fn new(waits: bool) -> Self {
        let now = Instant::now();
        Self {
            beside: ConsoleReporter::new(waits),
            shown: now,
            start: now,
            frames: 0,
            skipped: 0,
            first_skipped: None,
            dropped: 0,
            expected: None,
            age: Duration::ZERO,
            black: Uniform::default(),
            white: Uniform::default(),
            same: Uniform::default(),
            seen: Vec::new(),
            dark: BTreeMap::new(),
            saturated: BTreeMap::new(),
        }
    }

    /// Number of processed frames.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Returns the error message for a source without usable frames, which contains the reason for the first skipped
    /// image.
    pub fn nothing(&self) -> String {
        let skipped = match (self.skipped, &self.first_skipped) {
            (count, Some(first)) => format!("{count} skipped, the first: {first}"),
            (count, None) => format!("{count} skipped"),
        };
        format!("no frame was sensed ({skipped}); expected at least 1")
    }

    /// Counts a frame received at `at`.
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

    /// Like [`frame`](Self::frame), but also counts images that are identical to the previous one, which indicates a
    /// copy.
    pub fn picture(&mut self, sequence: u64, at: Instant, readings: &[ElementReading]) {
        let alike = |(a, b): (&ElementReading, &ElementReading)| {
            a.integrated_gray == b.integrated_gray && a.centroid == b.centroid
        };
        let lit = readings
            .iter()
            .any(|reading| reading.exposure == Exposure::Good);
        let all = self.seen.len() == readings.len() && self.seen.iter().zip(readings).all(alike);
        if lit && all {
            self.same.add(sequence);
        }
        self.seen.clear();
        self.seen.extend_from_slice(readings);
        self.frame(sequence, at, readings);
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

    /// Counts and reports a skipped image. It is not counted as dropped.
    pub fn skip(&mut self, reason: &str) {
        self.skipped += 1;
        self.first_skipped.get_or_insert_with(|| reason.to_owned());
        self.expected = self.expected.map(|expected| expected.saturating_add(1));
        self.warn(&format!("skipped: {reason}"));
    }

    /// Adds skipped lines of a table.
    pub fn skip_lines(&mut self, count: u64) {
        self.skipped += count;
    }

    /// Prints a warning.
    pub fn warn(&self, warning: &str) {
        self.beside.say(&format!("warning: {warning}"));
    }

    /// Prints a note.
    pub fn note(&self, note: &str) {
        self.beside.say(note);
    }

    /// Returns a function that prints warnings from another thread.
    pub fn warner(&self) -> Box<dyn FnMut(&str) + Send> {
        let mut say = self.beside.printer();
        Box::new(move |warning| say(&format!("warning: {warning}")))
    }

    /// Removes the progress line and prints the summary.
    pub fn close(&self) {
        self.beside.clear();
        let uniform = [(&self.black, "black"), (&self.white, "white")];
        for (uniform, colour) in uniform.into_iter().filter(|(u, _)| u.count > 0) {
            let first = uniform.first;
            let frames = frames(uniform.count);
            self.warn(&format!(
                "{frames} all {colour}, the first is frame {first}; no forces"
            ));
        }
        if self.same.count > 0 {
            let (same, first) = (frames(self.same.count), self.same.first);
            self.warn(&format!(
                "{same} with readings identical to the previous frame (kept), the first is frame {first}"
            ));
        }
        let lit = [(&self.dark, "dark"), (&self.saturated, "saturated")];
        for (elements, how) in lit.into_iter().filter(|(e, _)| !e.is_empty()) {
            let names = named(elements);
            self.warn(&format!("{how} sub-regions, force omitted: {names}"));
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
