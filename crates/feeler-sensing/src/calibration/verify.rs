//! `feeler verify`: tests whether a wrench calibration is still valid.

use super::checks::CONFIRM;
use super::guided::{FORCES, GuideOptions, Procedure, guide};
use super::passport::today;
use super::read_taxel_recordings;
use crate::{TaxelOptions, named_sensor, read_taxel_layout};
use feeler::sensor::table::Quantity;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::taxels::TaxelCalibration;
use feeler::sensor::wrench::verification::{AxisVerification, Verification, verify as test};
use feeler::sensor::wrench::{CalibrationOf, SampleOf, WrenchCalibration};
use feeler_console::{CommandError, Outcome, Outputs, PartFile, Steps, print_json, warn};
use feeler_lab::sensor::ForcesFile;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Calibration to test, presses, and output.
#[derive(Debug, Clone)]
pub struct VerifyOptions<'a> {
    /// Wrench calibration.
    pub calibration: PathBuf,
    /// Table of measured forces, or the folder for presses of a guided session.
    pub presses: PathBuf,
    /// Camera, force sensor and number of presses of a guided session; `None` to read `presses`.
    pub live: Option<(GuideOptions<'a>, u32)>,
    /// Layout of the taxel array, if the sensor is one.
    pub taxels: TaxelOptions,
    /// Located layout of a camera's sensor, in place of an experiment's fingertip.
    pub layout: Option<PathBuf>,
    /// Experiment that defines the fingertip: a file or a built-in name.
    pub experiment: String,
    /// Index of the finger in the experiment.
    pub finger: Option<usize>,
    /// Maximum probability of rejecting a valid calibration if presses are independent.
    pub false_alarm_rate: f64,
    /// File for the calibration with the result in its passport, or `None` to print the result only.
    pub output: Option<PathBuf>,
    /// `true` to replace an existing output.
    pub force: bool,
    /// `true` to print JSON.
    pub json: bool,
}

/// Tests a calibration with measured presses. Returns [`Outcome::Differs`] if it is no longer valid.
///
/// # Errors
/// If a file cannot be read or was made for another sensor, or if there are too few presses.
pub fn verify(options: &VerifyOptions<'_>, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let path = &options.calibration;
    let named = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = fs::read_to_string(path).map_err(|e| named(&e))?;
    if TaxelCalibration::is_kind(&text) {
        if options.live.is_some() {
            return Err(named(&"--live requires the calibration of a camera's sensor, got one of a taxel array; pass a table of presses instead").into());
        }
        let forces = ForcesFile::read(&options.presses)?;
        let calibration = TaxelCalibration::from_toml(&text).map_err(|e| named(&e))?;
        let layout = options.taxels.taxels.as_deref();
        let layout = layout.ok_or_else(|| {
            named(&"expected --taxels LAYOUT, because the calibration is for a taxel array")
        })?;
        let layout = read_taxel_layout(layout, &options.taxels, None)?;
        let target = layout.calibration_target()?;
        calibration.verify_target(&target).map_err(|e| named(&e))?;
        let tables: Vec<_> = forces
            .recordings()
            .iter()
            .map(|name| forces.path_of(name))
            .collect();
        let job = Job::new(options, calibration, tables)?;
        job.check(&forces)?;
        let progress = Steps::new(forces.recordings().len());
        let recordings = read_taxel_recordings(&forces, &layout, || progress.advance())?;
        drop(progress);
        recordings.problems.iter().for_each(|words| warn(words));
        return job.finish(&recordings.samples, out);
    }
    let mut sensor = named_sensor(
        &options.experiment,
        options.finger,
        options.layout.as_deref(),
    )?;
    let calibration = sensor
        .parse_wrench_calibration(&text)
        .map_err(|e| named(&e))?;
    let calibration: WrenchCalibration = calibration
        .ok_or_else(|| named(&"expected a calibration by `feeler calibrate --wrench`"))?;
    let (job, forces) = match &options.live {
        None => {
            let forces = ForcesFile::read(&options.presses)?;
            (Job::new(options, calibration, forces.files())?, forces)
        }
        Some((rig, wanted)) => {
            let job = Job::new(options, calibration, Vec::new())?;
            let presses = Procedure::Presses(full_scale(&job.calibration)?, *wanted);
            guide(rig, presses, &options.presses, &sensor)?;
            (job, ForcesFile::read(&options.presses.join(FORCES))?)
        }
    };
    job.check(&forces)?;
    let progress = Steps::new(forces.picture_count());
    let measured = forces.sense(&sensor, || progress.advance())?;
    drop(progress);
    measured
        .skipped
        .iter()
        .for_each(|reason| warn(&format!("skipped: {reason}")));
    job.finish(&measured.samples, out)
}

/// Largest calibrated force (N).
fn full_scale(calibration: &WrenchCalibration) -> Result<f64, CommandError> {
    let forces = calibration.quality.iter();
    let forces = forces.filter(|quality| quality.axis.quantity() == Quantity::Force);
    let ends = forces.flat_map(|quality| quality.range).map(f64::abs);
    let largest = ends.fold(0.0, f64::max);
    match largest > 0.0 {
        true => Ok(largest),
        false => Err("--live: expected a calibration with force components, got none".into()),
    }
}

/// A calibration to test, and the file for the result.
struct Job<'a, B: Basis> {
    options: &'a VerifyOptions<'a>,
    calibration: CalibrationOf<B>,
    file: Option<PartFile>,
}

impl<'a, B: Basis> Job<'a, B> {
    /// Creates a job, with its output file if one is requested.
    fn new(
        options: &'a VerifyOptions<'a>,
        calibration: CalibrationOf<B>,
        inputs: Vec<PathBuf>,
    ) -> Result<Self, CommandError> {
        let named = [
            Some(options.calibration.as_path()),
            Some(&options.presses),
            options.taxels.taxels.as_deref().map(Path::new),
            options.layout.as_deref(),
            Some(Path::new(&options.experiment)),
        ];
        let inputs = inputs.iter().map(|path| Some(path.as_path())).chain(named);
        let mut outputs = Outputs::new(options.force, inputs);
        let create = |path: &PathBuf| outputs.create(path, "--output");
        let file = options.output.as_ref().map(create).transpose()?;
        Ok(Self {
            options,
            calibration,
            file,
        })
    }

    /// Checks the unit of the forces.
    fn check(&self, forces: &ForcesFile) -> Result<(), CommandError> {
        let table = self.options.presses.display();
        let checked = match self.calibration.loads_confirmed {
            true => Ok(()),
            false => forces.check_magnitude(),
        };
        checked.map_err(|error| format!("{table}: {error}{CONFIRM}").into())
    }

    /// Tests the calibration, prints the result and writes the output.
    fn finish(
        mut self,
        samples: &[SampleOf<B>],
        out: &mut dyn Write,
    ) -> Result<Outcome, CommandError> {
        let options = self.options;
        let verification = test(
            &self.calibration,
            samples,
            &today(),
            options.false_alarm_rate,
        )
        .map_err(|e| format!("{}: {e}", options.presses.display()))?;
        if options.json {
            print_json(&verification, out)?;
        } else {
            print(&self.calibration, &verification, out)?;
        }
        let outcome = match verification.valid {
            true => Outcome::Done,
            false => Outcome::Differs,
        };
        self.calibration.add_verification(verification)?;
        if let (Some(file), Some(path)) = (self.file, &options.output) {
            file.finish(self.calibration.to_toml()?.as_bytes())?;
            if !options.json {
                writeln!(out, "{}", Path::display(path))?;
            }
        }
        Ok(outcome)
    }
}

/// Prints the result of each component.
fn print<B: Basis>(
    calibration: &CalibrationOf<B>,
    verification: &Verification,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<10}{:>9}{:>10}{:>15}{:>12}{:>10}{:>10}{:>8}",
        "", "presses", "outside", "rejected from", "95 % band", "RMSE", "bias", "gain"
    )?;
    for tested in &verification.axes {
        let AxisVerification {
            axis,
            presses,
            outside,
            rejected_from,
            errors,
            gain_drift,
        } = tested;
        let (unit, factor) = axis.shown_unit();
        let number =
            |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.4}", factor * value));
        let band = calibration
            .quality
            .iter()
            .find(|quality| quality.axis == *axis);
        writeln!(
            out,
            "{:<10}{presses:>9}{outside:>10}{rejected_from:>15}{:>12}{:>10}{:>10}{:>8}",
            format!("{} ({unit})", axis.name()),
            number(band.and_then(|quality| quality.band_95)),
            number(errors.map(|errors| errors.rmse)),
            number(errors.map(|errors| errors.bias)),
            gain_drift.map_or("-".into(), |gain| format!("{:+.1} %", 100.0 * gain)),
        )?;
    }
    let percent = 100.0 * verification.false_alarm_rate;
    match verification.valid {
        true => writeln!(out, "still valid (false-alarm rate at most {percent} %)"),
        false => writeln!(
            out,
            "no longer valid (false-alarm rate at most {percent} %); calibrate again"
        ),
    }
}
