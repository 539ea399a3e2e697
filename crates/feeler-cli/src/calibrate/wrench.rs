//! `feeler calibrate FORCES.csv --wrench`

use super::{
    Arguments, Calibrated, CommandError, Outcome, create_outputs, guide_live, page_path, sensor,
};
use feeler::sensor::wrench::quality::{HeldOut, outlier};
use feeler::sensor::wrench::{WrenchFit, fit};
use feeler_console::{Steps, Working, print_json, warn};
use feeler_lab::sensor::{ForcesFile, MeasuredSamples};
use feeler_sensing::calibration::checks::CONFIRM;
use feeler_sensing::calibration::{FORCES, wrench_page, wrench_table};
use std::io::Write;
use std::path::PathBuf;

/// Maximum number of images named in warnings.
const NAMED: usize = 5;

/// Calibrates the total force on a fingertip.
pub fn calibrate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let output = &arguments.output;
    let page_path = page_path(output)?;
    let sensor = sensor(arguments)?;
    let csv = match guide_live(arguments, &sensor, &page_path)? {
        Some(folder) => folder.join(FORCES),
        None => measured(arguments)?,
    };
    let forces = ForcesFile::read(&csv)?;
    if !arguments.confirm_loads {
        let checked = forces.check_magnitude();
        checked.map_err(|error| format!("{}: {error}{CONFIRM}", csv.display()))?;
    }
    // Opened first, because calibrating takes a while.
    let [file, page_file] = create_outputs(arguments, &forces.files(), &page_path)?;
    let progress = Steps::new(forces.picture_count());
    let measured = forces.sense(&sensor, || progress.advance())?;
    drop(progress);
    warn_of_skipped(&measured.skipped);
    let fitting = Working::on("fitting");
    let fitted = fit(
        sensor.made_for,
        forces.recordings(),
        &measured.samples,
        arguments.force_fit,
    );
    drop(fitting);
    let mut fitted = fitted.map_err(|e| format!("{}: {e}{}", csv.display(), advice(&e)))?;
    fitted.calibration.loads_confirmed = arguments.confirm_loads;
    warn_of_fit(&fitted, &measured, forces.recordings());
    let source = forces.name();
    page_file.finish(wrench_page(&fitted, forces.recordings(), &source).as_bytes())?;
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
fn warn_of_fit(fitted: &WrenchFit, measured: &MeasuredSamples, recordings: &[String]) {
    if fitted.unusable > 0 {
        let (unusable, all) = (fitted.unusable, measured.samples.len());
        warn(&format!(
            "ignored {unusable} of {all} images, in which more than a tenth of the elements are dark or saturated"
        ));
    }
    for (axis, r2) in &fitted.left_out {
        let name = axis.name();
        match r2 {
            Some(r2) => warn(&format!(
                "{name} is left out: the fit predicts no better than the mean (expected a held-out R² above 0, got {r2:.2}); --force-fit keeps it"
            )),
            None => warn(&format!(
                "{name} is left out: expected at least 10 distinct values in the images"
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
