//! Display for the operator while loading one element after another.

use super::screen::{Screen, missing_before_loads};
use feeler::sensor::calibration::{
    CalibrationTarget, ElementRecord, FullScale, LiveCalibration, LoadSample, ModelChoice, Seen,
    Stage, fit,
};
use feeler::sensor::moments::ElementMoments;
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use std::fmt::Write as _;

/// Number of new samples of an element after which its error is estimated again.
const SAMPLES: usize = 8;
/// Tension, as a fraction of full scale, above which the force sensor's axes must be wrong: a probe cannot pull.
const PULLED: f64 = 0.1;
/// Maximum number of missing elements that are listed.
const NAMED: usize = 8;

pub struct Guide<'a> {
    sensor: &'a SensorGeometry,
    full_scale: FullScale,
    model: ModelChoice,
    complete: usize,
    seen: Seen,
    /// Samples of each element in this session, to estimate the error of its calibration.
    records: Vec<ElementRecord>,
    /// Element whose error was estimated last, and its root mean square error along x, y, z (N).
    error: Option<(usize, DVec3)>,
}

impl<'a> Guide<'a> {
    pub fn new(sensor: &'a SensorGeometry, full_scale: FullScale, model: ModelChoice) -> Self {
        Self {
            sensor,
            full_scale,
            model,
            complete: 0,
            seen: Seen::Nothing,
            records: vec![ElementRecord::default(); sensor.kernel.element_count()],
            error: None,
        }
    }

    /// Registers how the latest image was used.
    pub fn seen(&mut self, seen: &Seen, screen: &mut Screen) {
        if let Seen::Enough { element, force } = *seen
            && force.z < -PULLED * self.full_scale.normal
        {
            screen.warn(&format!(
                "element {element} seems to be pulled; check --force-axes"
            ));
        }
        self.seen = *seen;
    }

    /// Adds a sample, and estimates the element's error after every few samples.
    pub fn sample(&mut self, element: usize, force: DVec3, moments: &[ElementMoments]) {
        for (index, (record, &moments)) in self.records.iter_mut().zip(moments).enumerate() {
            // The other elements are unloaded. A reference is the mean of a limited number of images.
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
        let made_for = CalibrationTarget {
            elements: 1,
            ..self.sensor.made_for.clone()
        };
        let record = std::slice::from_ref(record);
        // The fit fails as long as there are too few samples of one kind.
        if let Ok(fitted) = fit(made_for, record, self.model, self.full_scale) {
            let rms = fitted.elements.first().map(|own| own.quality.held_out.rms);
            self.error = rms.map(|rms| (element, rms));
        }
    }

    /// Shows the progress.
    pub fn show(&mut self, calibration: &LiveCalibration, screen: &mut Screen) {
        let stage = match calibration.stage() {
            Stage::Untouched { .. } => "do not touch the fingertip",
            Stage::Presses { .. } => {
                "press and release any element three times, to measure the camera's latency"
            }
            Stage::Loads => "load one element after another",
        };
        let coverage = calibration.coverage();
        let complete = coverage
            .iter()
            .filter(|element| element.is_complete())
            .count();
        screen.stage(calibration.stage(), stage, calibration.delay());
        if complete > self.complete {
            let all = coverage.len();
            screen.step(&format!("{complete} of {all} elements complete"));
            if let Some(error) = &self.error {
                screen.step(&in_words(error));
            }
        }
        self.complete = complete;
        if screen.is_due() {
            screen.draw(self.lines(stage, calibration));
        }
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
        // Writing to a `String` cannot fail.
        let _ = writeln!(text, "next: {}", names.join("; "));
        if let Some(error) = &self.error {
            let _ = writeln!(text, "{}", in_words(error));
        }
        text
    }

    /// Describes the current contact, and the loads missing from the touched element.
    fn now(&self, calibration: &LiveCalibration) -> String {
        match self.seen {
            Seen::Sample { element, force } | Seen::Enough { element, force } => {
                let missing = calibration.coverage()[element]
                    .missing(calibration.goal())
                    .to_string();
                let missing = if missing.is_empty() {
                    "complete; continue with another element"
                } else {
                    &missing
                };
                let DVec3 { x, y, z } = force;
                format!("element {element}: {z:.2} N, shear {x:+.2}, {y:+.2} N; {missing}")
            }
            Seen::Unclear => "touch only one element, and more slowly".into(),
            Seen::Untouched | Seen::Nothing => "no contact".into(),
        }
    }
}

/// Describes the error of an element's calibration so far.
fn in_words((element, rms): &(usize, DVec3)) -> String {
    let mn = 1e3 * *rms;
    format!(
        "element {element}, held-out errors (rms): {:.0}, {:.0} mN shear, {:.0} mN compression",
        mn.x, mn.y, mn.z
    )
}
