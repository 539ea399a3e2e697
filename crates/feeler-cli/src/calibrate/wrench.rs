//! `feeler calibrate FORCES.csv --wrench`: calibrates the total force on a fingertip.

use super::{
    Arguments, Calibrated, CommandError, Outcome, create_outputs, guide_live, page_path, sensor,
};
use feeler::sensor::fingertip::CalibrationTarget;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::passport::Passport;
use feeler::sensor::wrench::quality::{HeldOut, outlier};
use feeler::sensor::wrench::taxels::MAX_DELAY;
use feeler::sensor::wrench::transfer::transfer;
use feeler::sensor::wrench::{CalibrationOf, FitOf, SampleOf, fit};
use feeler_console::{PartFile, Steps, Working, print_json, warn};
use feeler_lab::sensor::ForcesFile;
use feeler_sensing::calibration::checks::CONFIRM;
use feeler_sensing::calibration::{
    FORCES, read_taxel_recordings, today, wrench_page, wrench_table,
};
use feeler_sensing::{TaxelOptions, read_taxel_layout};
use std::fmt::Display;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Maximum number of images named in warnings.
const NAMED: usize = 5;

/// Calibrates the total force on a fingertip with a camera or a taxel array.
pub fn calibrate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.taxels {
        Some(layout) => calibrate_taxels(arguments, layout, out),
        None => calibrate_camera(arguments, out),
    }
}

fn calibrate_camera(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let page_path = page_path(&arguments.output)?;
    let sensor = sensor(arguments)?;
    let csv = match guide_live(arguments, &sensor, &page_path)? {
        Some(folder) => folder.join(FORCES),
        None => measured(arguments)?,
    };
    let forces = read(arguments, &csv)?;
    // Opened first, because calibrating takes a while.
    let inputs: Vec<_> = forces
        .files()
        .into_iter()
        .chain(arguments.from.clone())
        .collect();
    let files = create_outputs(arguments, &inputs, &page_path)?;
    let progress = Steps::new(forces.picture_count());
    let measured = forces.sense(&sensor, || progress.advance())?;
    drop(progress);
    warn_of_skipped(&measured.skipped);
    let fitted = fit_to(arguments, sensor.made_for, &forces, &measured.samples)?;
    write_fitted(arguments, files, &fitted, &forces, out)
}

fn calibrate_taxels(
    arguments: &Arguments,
    layout: &str,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let page_path = page_path(&arguments.output)?;
    let options = TaxelOptions {
        prefix: arguments.prefix.clone(),
        ..TaxelOptions::default()
    };
    let layout = read_taxel_layout(layout, &options, None)?;
    let forces = read(arguments, &measured(arguments)?)?;
    let tables = forces.recordings().iter().map(|name| forces.path_of(name));
    let inputs: Vec<_> = tables
        .chain(forces.files())
        .chain(arguments.from.clone())
        .collect();
    let files = create_outputs(arguments, &inputs, &page_path)?;
    let progress = Steps::new(forces.recordings().len());
    let recordings = read_taxel_recordings(&forces, &layout, || progress.advance())?;
    drop(progress);
    recordings.problems.iter().for_each(|words| warn(words));
    let delay = recordings.delay;
    if delay.abs() >= MAX_DELAY && !arguments.force_fit {
        return Err(format!(
            "{}: expected forces delayed by less than {MAX_DELAY} s after the taxels, got {delay:.2} s or more; use one clock for \
             both; --force-fit accepts it",
            forces.name()
        )
        .into());
    }
    let target = layout.calibration_target()?;
    let fitted = fit_to(arguments, target, &forces, &recordings.samples)?;
    if !arguments.json.json {
        let rows = recordings.samples.len();
        writeln!(out, "{rows} rows of taxels with a measured wrench")?;
        if delay != 0.0 {
            writeln!(out, "compensated a delay of the forces of {delay:.2} s")?;
        }
    }
    write_fitted(arguments, files, &fitted, &forces, out)
}

/// Reads the table of forces at `csv` and checks their magnitude.
fn read(arguments: &Arguments, csv: &Path) -> Result<ForcesFile, CommandError> {
    let forces = ForcesFile::read(csv)?;
    if !arguments.confirm_loads {
        let checked = forces.check_magnitude();
        checked.map_err(|error| format!("{}: {error}{CONFIRM}", csv.display()))?;
    }
    Ok(forces)
}

/// Fits a calibration for `made_for` to `samples`, with warnings.
fn fit_to<B: Basis>(
    arguments: &Arguments,
    made_for: CalibrationTarget,
    forces: &ForcesFile,
    samples: &[SampleOf<B>],
) -> Result<FitOf<B>, CommandError> {
    let source = arguments
        .from
        .as_deref()
        .map(read_source::<B>)
        .transpose()?;
    if let Some(source) = source.as_ref().filter(|s| s.tracked != arguments.track) {
        return Err(match source.tracked {
            true => "--from: expected --track, because the calibration is of tracked markers",
            false => "--track: expected --from with a calibration of tracked markers",
        }
        .into());
    }
    let fitting = Working::on("fitting");
    let fitted = match &source {
        Some(source) => transfer(
            source,
            made_for,
            forces.recordings(),
            samples,
            arguments.force_fit,
        ),
        None => fit(made_for, forces.recordings(), samples, arguments.force_fit),
    };
    drop(fitting);
    let mut fitted = fitted.map_err(|e| format!("{}: {e}{}", forces.name(), advice(&e)))?;
    fitted.calibration.loads_confirmed = arguments.confirm_loads;
    fitted.calibration.tracked = arguments.track;
    let transferred_from = source.map(|source| source.checksum()).transpose()?;
    fitted.calibration.sign(Passport {
        date: today(),
        conditions: arguments.conditions.clone(),
        transferred_from,
        ..Passport::default()
    })?;
    warn_of_fit(&fitted, samples.len(), forces.recordings());
    Ok(fitted)
}

/// Reads the calibration to transfer.
fn read_source<B: Basis>(path: &Path) -> Result<CalibrationOf<B>, CommandError> {
    let named = |e: &dyn Display| format!("--from {}: {e}", path.display());
    let text = fs::read_to_string(path).map_err(|e| named(&e))?;
    Ok(CalibrationOf::from_toml(&text).map_err(|e| named(&e))?)
}

/// Writes the calibration and its report to `files`, and prints the errors.
fn write_fitted<B: Basis>(
    arguments: &Arguments,
    [file, page_file]: [PartFile; 2],
    fitted: &FitOf<B>,
    forces: &ForcesFile,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let output = &arguments.output;
    let page_path = page_path(output)?;
    let page = wrench_page(fitted, forces.recordings(), &forces.name());
    page_file.finish(page.as_bytes())?;
    file.finish(fitted.calibration.to_toml()?.as_bytes())?;
    if arguments.json.json {
        let calibrated = Calibrated {
            calibration: output,
            page: &page_path,
            of: "wrench",
            full_scale: None,
            elements: Vec::new(),
            components: &fitted.calibration.quality,
        };
        print_json(&calibrated, out)?;
        return Ok(Outcome::Done);
    }
    write!(out, "{}", wrench_table(&fitted.calibration))?;
    writeln!(out, "{}\n{}", output.display(), page_path.display())?;
    Ok(Outcome::Done)
}

/// Returns the path of the table of measured forces.
fn measured(arguments: &Arguments) -> Result<PathBuf, CommandError> {
    if arguments.full_scale_normal.is_some() || arguments.full_scale_shear.is_some() {
        let message = "--full-scale-normal, --full-scale-shear: with --wrench these require --live, because a wrench calibration has no full scale";
        return Err(message.into());
    }
    if arguments.axes.are_given() {
        let message = "--force-axes: with --wrench this requires --live; forces in a table stay in the frame in which they were measured";
        return Err(message.into());
    }
    let csv = arguments.input.as_deref();
    let csv = csv.ok_or("--wrench requires FORCES.csv, the table of measured forces")?;
    Ok(PathBuf::from(csv))
}

/// Returns the advice for an error.
fn advice(error: &feeler::sensor::wrench::WrenchError) -> &'static str {
    use feeler::sensor::wrench::WrenchError;
    match error {
        WrenchError::ExplainsNothing { .. } => "; --force-fit accepts it anyway",
        _ => "",
    }
}

fn warn_of_skipped(skipped: &[String]) {
    for reason in skipped.iter().take(NAMED) {
        warn(&format!("skipped: {reason}"));
    }
    if skipped.len() > NAMED {
        warn(&format!("skipped {} more images", skipped.len() - NAMED));
    }
}

/// Warns of ignored images and of components that are left out or doubtful.
fn warn_of_fit<B: Basis>(fitted: &FitOf<B>, all: usize, recordings: &[String]) {
    if fitted.unusable > 0 {
        let unusable = fitted.unusable;
        warn(&format!(
            "ignored {unusable} of {all} samples, in which more than a tenth of the elements are missing, dark or saturated"
        ));
    }
    for (axis, r2) in &fitted.left_out {
        let name = axis.name();
        match r2 {
            Some(r2) => warn(&format!(
                "{name} is left out: the fit predicts no better than the mean (expected a held-out R² above 0, got {r2:.2}); --force-fit keeps it"
            )),
            None => warn(&format!(
                "{name} is left out: expected at least 10 distinct values"
            )),
        }
    }
    for (quality, held_out) in fitted.calibration.quality.iter().zip(&fitted.held_out) {
        if let Some(HeldOut {
            recording,
            measured,
            by_blocks: Some(predicted),
            ..
        }) = outlier(held_out)
        {
            let (name, unit, recording) = (
                quality.axis.name(),
                quality.axis.unit(),
                &recordings[recording],
            );
            warn(&format!(
                "{name} = {measured} {unit} in recording {recording:?} is far from the prediction {predicted:.3} {unit}; check for a typo"
            ));
        }
        if !quality.explains() {
            let (name, r2) = (quality.axis.name(), quality.r2);
            warn(&format!(
                "{name} is kept because of --force-fit, although the fit predicts no better than the mean (held-out R² {r2:.2})"
            ));
        }
    }
}
