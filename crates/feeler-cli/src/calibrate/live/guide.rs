//! What a person who loads a fingertip is told.

use feeler::sensor::calibration::{FullScale, MadeFor};
use feeler::sensor::calibration_fit::{ElementRecord, LoadSample, ModelChoice, fit};
use feeler::sensor::live_calibration::{LiveCalibration, Seen, Stage};
use feeler::sensor::moments::ElementMoments;
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use indicatif::{ProgressBar, ProgressStyle};
use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _, stderr};
use std::time::{Duration, Instant};

/// Redrawn this often at most.
const INTERVAL: Duration = Duration::from_millis(100);
/// New samples of an element after which its error is found anew.
const SAMPLES: usize = 8;
/// A probe does not pull: where a force does by so much of full scale, the force sensor's axes are others than said.
const PULLED: f64 = 0.1;
/// Elements that are named as missing at most.
const NAMED: usize = 8;

/// The screen: a few lines on a terminal; elsewhere a line for each step that is done.
pub struct Guide<'a> {
    sensor: &'a SensorGeometry,
    full_scale: FullScale,
    model: ModelChoice,
    bar: ProgressBar,
    on_terminal: bool,
    drawn: Instant,
    stage: Option<&'static str>,
    complete: usize,
    seen: Seen,
    warning: Option<(String, Instant)>,
    /// What was taken of each element since the start, to tell how well it can be fitted.
    records: Vec<ElementRecord>,
    /// The element whose error was found last, and its root mean square along x, y, z, N.
    error: Option<(usize, DVec3)>,
}

impl<'a> Guide<'a> {
    pub fn new(sensor: &'a SensorGeometry, full_scale: FullScale, model: ModelChoice) -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        Self {
            sensor,
            full_scale,
            model,
            bar,
            on_terminal: stderr().is_terminal(),
            drawn: Instant::now(),
            stage: None,
            complete: 0,
            seen: Seen::Nothing,
            warning: None,
            records: vec![ElementRecord::default(); sensor.kernel.element_count()],
            error: None,
        }
    }

    /// Takes what the newest picture was good for.
    pub fn seen(&mut self, seen: &Seen) {
        if let Seen::Enough { element, force } = *seen
            && force.z < -PULLED * self.full_scale.normal
        {
            self.warn(&format!(
                "element {element} seems to be pulled: is --force-axes right?"
            ));
        }
        self.seen = *seen;
    }

    /// Takes a sample; finds the element's error where enough have come.
    pub fn sample(&mut self, element: usize, force: DVec3, moments: &[ElementMoments]) {
        for (index, (record, &moments)) in self.records.iter_mut().zip(moments).enumerate() {
            // The others are not touched. A reference is the mean of some pictures, not of all.
            if index == element {
                record.fitted.push(LoadSample { force, moments });
            } else if record.unloaded.len() < 64 {
                record.unloaded.push(moments);
            }
        }
        let record = &self.records[element];
        if !record.fitted.len().is_multiple_of(SAMPLES) {
            return;
        }
        let made_for = MadeFor {
            elements: 1,
            ..self.sensor.made_for.clone()
        };
        let record = std::slice::from_ref(record);
        // Too few of a kind determine no map: it is found when there are more.
        if let Ok(fitted) = fit(made_for, record, self.model, self.full_scale) {
            let rms = fitted.elements.first().map(|own| own.quality.held_out.rms);
            self.error = rms.map(|rms| (element, rms));
        }
    }

    /// Says that something is wrong which may pass.
    pub fn warn(&mut self, what: &str) {
        let is_new = self.warning.as_ref().is_none_or(|(said, _)| said != what);
        if is_new && !self.on_terminal {
            say(&format!("warning: {what}"));
        }
        self.warning = Some((what.to_string(), Instant::now()));
    }

    /// Shows how far it is.
    pub fn show(&mut self, calibration: &LiveCalibration) {
        let stage = match calibration.stage() {
            Stage::Untouched { .. } => "do not touch the fingertip",
            Stage::Presses { .. } => {
                "press any element three times and let go, to find how late the camera is"
            }
            Stage::Loads => "load one element after the other",
        };
        let coverage = calibration.coverage();
        let complete = coverage
            .iter()
            .filter(|element| element.is_complete())
            .count();
        if !self.on_terminal {
            if self.stage != Some(stage) {
                say(stage);
                if let (Stage::Loads, Some(delay)) = (calibration.stage(), calibration.delay()) {
                    say(&format!("the camera is {:.0} ms late", 1e3 * delay.seconds));
                }
            }
            if complete > self.complete {
                say(&format!(
                    "{complete} of {} elements complete",
                    coverage.len()
                ));
            }
            (self.stage, self.complete) = (Some(stage), complete);
            return;
        }
        if self.drawn.elapsed() < INTERVAL {
            return;
        }
        self.drawn = Instant::now();
        self.bar
            .set_message(self.lines(stage, complete, calibration));
    }

    /// Takes it off the screen.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn lines(&self, stage: &str, complete: usize, calibration: &LiveCalibration) -> String {
        let coverage = calibration.coverage();
        let mut text = format!(
            "{complete} of {} elements complete: {stage}\n",
            coverage.len()
        );
        // Writing to a string does not fail.
        let _ = match calibration.stage() {
            Stage::Untouched { missing } => writeln!(text, "{missing} more pictures"),
            Stage::Presses { missing, found } => match found {
                Some(delay) => writeln!(
                    text,
                    "pictures and forces do not go together well (correlation {:.2}, 0.9 expected): press slower",
                    delay.correlation
                ),
                None => writeln!(text, "{missing} more presses"),
            },
            Stage::Loads => {
                let words = self.now(calibration);
                writeln!(text, "{words}")
            }
        };
        let missing = coverage
            .iter()
            .enumerate()
            .filter(|(_, element)| !element.is_complete());
        let names: Vec<String> = missing
            .take(NAMED)
            .map(|(element, known)| {
                let place = self.sensor.seen[element].centre_px;
                let part = 100.0 * known.part();
                format!(
                    "{element} at ({:.0}, {:.0}) px {part:.0} %",
                    place.x, place.y
                )
            })
            .collect();
        let _ = writeln!(text, "next: {}", names.join("; "));
        if let Some((element, rms)) = self.error {
            let mn = 1e3 * rms;
            let _ = writeln!(
                text,
                "element {element}, held-out errors (rms): {:.0}, {:.0} mN shear, {:.0} mN compression",
                mn.x, mn.y, mn.z
            );
        }
        if let Some((warning, _)) = self
            .warning
            .as_ref()
            .filter(|(_, at)| at.elapsed().as_secs() < 3)
        {
            let _ = writeln!(text, "warning: {warning}");
        }
        text
    }

    /// What is touched now and what is missing of it, in words.
    fn now(&self, calibration: &LiveCalibration) -> String {
        match self.seen {
            Seen::Sample { element, force } | Seen::Enough { element, force } => {
                let missing = calibration.coverage()[element]
                    .missing(calibration.goal())
                    .to_string();
                let missing = if missing.is_empty() {
                    "complete: go on to another"
                } else {
                    &missing
                };
                let DVec3 { x, y, z } = force;
                format!("element {element}: {z:.2} N, shear {x:+.2}, {y:+.2} N; {missing}")
            }
            Seen::Unclear => "touch one element alone, and slower".into(),
            Seen::Untouched | Seen::Nothing => "nothing is touched".into(),
        }
    }
}

fn say(words: &str) {
    // Standard error that is closed is no reason to stop.
    let _ = writeln!(stderr(), "{words}");
}
