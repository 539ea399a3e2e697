//! What a person who loads one element after the other is told.

use super::screen::{Screen, missing_before_loads};
use feeler::sensor::calibration::{FullScale, MadeFor};
use feeler::sensor::calibration_fit::{ElementRecord, LoadSample, ModelChoice, fit};
use feeler::sensor::live_calibration::{LiveCalibration, Seen, Stage};
use feeler::sensor::moments::ElementMoments;
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use std::fmt::Write as _;

/// New samples of an element after which its error is found anew.
const SAMPLES: usize = 8;
/// A probe does not pull: where a force does by so much of full scale, the force sensor's axes are others than said.
const PULLED: f64 = 0.1;
/// Elements that are named as missing at most.
const NAMED: usize = 8;

pub struct Guide<'a> {
    sensor: &'a SensorGeometry,
    full_scale: FullScale,
    model: ModelChoice,
    screen: Screen,
    complete: usize,
    seen: Seen,
    /// What was taken of each element since the start, to tell how well it can be fitted.
    records: Vec<ElementRecord>,
    /// The element whose error was found last, and its root mean square along x, y, z, N.
    error: Option<(usize, DVec3)>,
}

impl<'a> Guide<'a> {
    pub fn new(sensor: &'a SensorGeometry, full_scale: FullScale, model: ModelChoice) -> Self {
        Self {
            sensor,
            full_scale,
            model,
            screen: Screen::new(),
            complete: 0,
            seen: Seen::Nothing,
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
        self.screen.warn(what);
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
        self.screen
            .stage(calibration.stage(), stage, calibration.delay());
        if complete > self.complete {
            let all = coverage.len();
            self.screen
                .step(&format!("{complete} of {all} elements complete"));
            if let Some(error) = &self.error {
                self.screen.step(&in_words(error));
            }
        }
        self.complete = complete;
        if self.screen.is_due() {
            self.screen.draw(self.lines(stage, calibration));
        }
    }

    /// Takes it off the screen.
    pub fn end(&self) {
        self.screen.end();
    }

    fn lines(&self, stage: &str, calibration: &LiveCalibration) -> String {
        let coverage = calibration.coverage();
        let (complete, all) = (self.complete, coverage.len());
        let now = missing_before_loads(calibration.stage());
        let now = now.unwrap_or_else(|| self.now(calibration));
        let mut text = format!("{complete} of {all} elements complete: {stage}\n{now}\n");
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
        // Writing to a string does not fail.
        let _ = writeln!(text, "next: {}", names.join("; "));
        if let Some(error) = &self.error {
            let _ = writeln!(text, "{}", in_words(error));
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

/// How far an element's calibration is off so far.
fn in_words((element, rms): &(usize, DVec3)) -> String {
    let mn = 1e3 * *rms;
    format!(
        "element {element}, held-out errors (rms): {:.0}, {:.0} mN shear, {:.0} mN compression",
        mn.x, mn.y, mn.z
    )
}
