//! Guided loading of the whole fingertip, for sensors whose elements cannot be loaded singly; saved as images with
//! FORCES.csv.

use super::folder::Folder;
use super::screen::{Screen, missing_before_loads};
use super::{FORCES, Work};
use feeler::sensor::calibration::{Goal, LiveWrench, SeenWrench, Stage, Wrench, WrenchCoverage};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::wrench::{WrenchSample, fit};
use feeler_console::CommandError;
use feeler_lab::sensor::{ForcesFile, SensorGeometry};
use std::fmt::Write as _;
use std::path::Path;

/// Tension, as a fraction of full scale, above which the force sensor's axes must be wrong: a probe cannot pull.
const PULLED: f64 = 0.1;

pub struct Whole<'a> {
    sensor: &'a SensorGeometry,
    kept: Folder,
    live: LiveWrench,
    seen: SeenWrench,
    /// Name of this session's recording in the table.
    recording: String,
    /// Samples of this session, from which the errors are estimated after each round.
    samples: Vec<WrenchSample>,
    /// Number of the round after which the errors were last estimated.
    round: u32,
    /// Latest estimate of the errors, as text.
    errors: Option<String>,
}

impl<'a> Whole<'a> {
    /// Opens the folder at `path`, which may contain the results of an earlier session.
    ///
    /// # Errors
    /// If the folder is not writable or contains other files.
    pub fn open(path: &Path, sensor: &'a SensorGeometry, goal: Goal) -> Result<Self, CommandError> {
        let columns = "picture,f_x,f_y,f_z,m_x,m_y,m_z,recording,time";
        let (mut kept, has_rows) = Folder::open(path, FORCES, columns)?;
        let mut coverage = WrenchCoverage::default();
        let mut recordings = 0;
        if has_rows {
            let forces = ForcesFile::read(kept.table())?;
            kept.count(forces.picture_count());
            recordings = forces.recordings().len();
            forces.each_force(|force| {
                coverage.count(force, &goal);
            });
        }
        Ok(Self {
            sensor,
            kept,
            round: coverage.round(),
            live: LiveWrench::new(goal, coverage),
            seen: SeenWrench::Nothing,
            recording: format!("live_{}", recordings + 1),
            samples: Vec::new(),
            errors: None,
        })
    }

    fn keep(
        &mut self,
        at: f64,
        picture: &Picture,
        wrench: Wrench,
        moments: &[ElementMoments],
    ) -> Result<(), CommandError> {
        let ([x, y, z], [a, b, c]) = (wrench.force.to_array(), wrench.torque.to_array());
        let values = [x, y, z, a, b, c];
        let mut row = String::new();
        for value in values {
            // Writing to a `String` cannot fail.
            let _ = write!(row, "{value},");
        }
        let _ = write!(row, "{},{at}", self.recording);
        self.kept.add(picture, &row)?;
        let lit = |moments: &ElementMoments| {
            let gray = moments.integrated_gray;
            (gray.is_finite() && gray > 0.0).then_some(*moments)
        };
        self.samples.push(WrenchSample {
            recording: 0,
            seen: moments.iter().map(lit).collect(),
            wrench: std::array::from_fn(|axis| values.get(axis).copied()),
        });
        Ok(())
    }

    /// Estimates the errors again after each round.
    fn judge(&mut self, screen: &Screen) {
        let round = self.live.coverage().round();
        if round <= self.round {
            return;
        }
        self.round = round;
        let made_for = self.sensor.made_for.clone();
        let fitted = fit(
            made_for,
            std::slice::from_ref(&self.recording),
            &self.samples,
            false,
        );
        self.errors = Some(match fitted {
            Ok(fitted) => {
                let qualities = fitted.calibration.quality.iter();
                let errors = qualities.map(|quality| {
                    let (axis, rmse) = (quality.axis, quality.blocks.rmse);
                    format!("{} {rmse:.4} {}", axis.name(), axis.unit())
                });
                let errors: Vec<String> = errors.collect();
                format!("held-out errors (RMSE): {}", errors.join(", "))
            }
            Err(error) => format!("held-out errors not available yet: {error}"),
        });
        let (rounds, errors) = (WrenchCoverage::rounds(), self.errors.as_deref());
        let errors = errors.unwrap_or_default();
        screen.step(&format!("round {round} of {rounds} done; {errors}"));
    }

    /// Describes the current contact and the missing loads.
    fn now(&self) -> String {
        let missing = self.live.coverage().missing(self.live.goal());
        match self.seen {
            SeenWrench::Sample(wrench) | SeenWrench::Enough(wrench) => {
                let force = wrench.force;
                format!(
                    "{:.2} N, shear {:+.2}, {:+.2} N\nmissing: {missing}",
                    -force.z, force.x, force.y
                )
            }
            SeenWrench::Unclear => format!("press more slowly\nmissing: {missing}"),
            SeenWrench::Untouched | SeenWrench::Nothing => {
                format!("no contact\nmissing: {missing}")
            }
        }
    }

    fn lines(&self, stage: &str) -> String {
        let coverage = self.live.coverage();
        let (part, rounds) = (100.0 * coverage.part(), WrenchCoverage::rounds());
        let round = (coverage.round() + 1).min(rounds);
        let mut text = format!("{part:.0} % complete, round {round} of {rounds}: {stage}\n");
        let now = missing_before_loads(self.live.stage()).unwrap_or_else(|| self.now());
        let _ = writeln!(text, "{now}");
        if let Some(errors) = &self.errors {
            let _ = writeln!(text, "{errors}");
        }
        text
    }
}

impl Work for Whole<'_> {
    fn load(&mut self, at: f64, load: Wrench) {
        self.live.wrench(at, load);
    }

    fn is_ready(&self, at: f64) -> bool {
        self.live.is_ready(at)
    }

    fn picture(
        &mut self,
        at: f64,
        picture: &Picture,
        moments: &[ElementMoments],
        screen: &mut Screen,
    ) -> Result<(), CommandError> {
        self.seen = self.live.picture(at, moments);
        match self.seen {
            SeenWrench::Untouched => self.keep(at, picture, Wrench::default(), moments)?,
            SeenWrench::Sample(wrench) => {
                self.keep(at, picture, wrench, moments)?;
                self.judge(screen);
            }
            SeenWrench::Enough(wrench) if wrench.force.z > PULLED * self.live.goal().normal => {
                let what =
                    "the fingertip seems to be pulled; check --force-axes (z points outward)";
                screen.warn(what);
            }
            SeenWrench::Enough(_) | SeenWrench::Nothing | SeenWrench::Unclear => {}
        }
        Ok(())
    }

    fn show(&mut self, screen: &mut Screen) {
        let stage = match self.live.stage() {
            Stage::Untouched { .. } => "do not touch the fingertip",
            Stage::Presses { .. } => {
                "press and release the fingertip three times, to measure the camera's latency"
            }
            Stage::Loads => "press and shear the fingertip everywhere and in all directions",
        };
        screen.stage(self.live.stage(), stage, self.live.delay());
        if screen.is_due() {
            screen.draw(self.lines(stage));
        }
    }

    fn kept(&self) -> &Folder {
        &self.kept
    }

    fn missing(&self) -> Option<String> {
        let coverage = self.live.coverage();
        let (round, rounds) = (coverage.round(), WrenchCoverage::rounds());
        (!coverage.is_complete()).then(|| format!("{round} of {rounds} rounds done"))
    }
}
