//! `feeler calibrate FORCES.csv --wrench`

use super::{
    Arguments, Calibrated, CommandError, Outcome, experiment_name, live, page_path, refuse_existing,
};
use feeler::sensor::wrench::quality::{HeldOut, outlier};
use feeler::sensor::wrench::{WrenchFit, fit};
use feeler_console::Outputs;
use feeler_console::print_json;
use feeler_console::warn;
use feeler_console::{Steps, Working};
use feeler_lab::sensor::{ForcesFile, MeasuredSamples};
use feeler_sensing::calibration::checks::CONFIRM;
use feeler_sensing::calibration::{FORCES, wrench_page, wrench_table};
use feeler_sensing::named_sensor;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Pictures that are named in warnings at most.
const NAMED: usize = 5;

/// Calibrates by what was measured of the whole fingertip.
pub fn calibrate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let output = &arguments.output;
    let page_path = page_path(output)?;
    let experiment_name = experiment_name(arguments);
    let layout = arguments.layout.as_deref();
    let sensor = named_sensor(experiment_name, arguments.finger, layout)?;
    let csv = match live::folder(arguments) {
        Some(folder) => {
            // Before an hour's work, not after it.
            refuse_existing(arguments, [output, &page_path])?;
            live::guide(arguments, folder, &sensor)?;
            folder.join(FORCES)
        }
        None => measured(arguments)?,
    };
    let forces = ForcesFile::read(&csv)?;
    if !arguments.confirm_loads {
        let checked = forces.check_magnitude();
        checked.map_err(|error| format!("{}: {error}{CONFIRM}", csv.display()))?;
    }
    let files = forces.files();
    let inputs = files.iter().map(|path| Some(path.as_path()));
    let named = [Some(Path::new(experiment_name)), layout];
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs.chain(named));
    // Opened first, for calibrating takes its time.
    let file = outputs.create(output, "--output")?;
    let page_file = outputs.create(&page_path, "--output")?;
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
    let mut fitted = fitted.map_err(|e| format!("{}: {e}{}", csv.display(), way_out(&e)))?;
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

/// The file of measured forces.
fn measured(arguments: &Arguments) -> Result<PathBuf, CommandError> {
    if arguments.full_scale_normal.is_some() || arguments.full_scale_shear.is_some() {
        let message = "--full-scale-normal, --full-scale-shear: expected --live beside --wrench, which has no full scale itself";
        return Err(message.into());
    }
    if arguments.axes.are_given() {
        let message = "--force-axes: expected --live beside --wrench, which takes a table's forces in the frame in which they were measured";
        return Err(message.into());
    }
    let csv = arguments.input.as_deref();
    let csv = csv.ok_or("--wrench: expected FORCES.csv, the file of measured forces")?;
    Ok(PathBuf::from(csv))
}

/// What can be done about an error.
fn way_out(error: &feeler::sensor::wrench::WrenchError) -> &'static str {
    use feeler::sensor::wrench::WrenchError;
    match error {
        WrenchError::ExplainsNothing { .. } => "; --force-fit keeps it all the same",
        _ => "",
    }
}

fn warn_of_skipped(skipped: &[String]) {
    for reason in skipped.iter().take(NAMED) {
        warn(&format!("skipped: {reason}"));
    }
    if skipped.len() > NAMED {
        warn(&format!("skipped {} more pictures", skipped.len() - NAMED));
    }
}

/// Says what was not used, and what is not in the calibration.
fn warn_of_fit(fitted: &WrenchFit, measured: &MeasuredSamples, recordings: &[String]) {
    if fitted.unusable > 0 {
        let (unusable, all) = (fitted.unusable, measured.samples.len());
        warn(&format!(
            "in {unusable} of {all} pictures, over a tenth of the elements are dark or saturated; nothing is learned from them"
        ));
    }
    for (axis, r2) in &fitted.left_out {
        let name = axis.name();
        match r2 {
            Some(r2) => warn(&format!(
                "{name} is left out: the pictures explain nothing of it (held-out R² {r2:.2}, above 0 expected); --force-fit keeps it"
            )),
            None => warn(&format!(
                "{name} is left out: at least 10 different values in pictures expected"
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
                "{name} = {measured} {unit} in recording {recording:?} is far from what the pictures show, {predicted:.3} {unit}: is it mistyped?"
            ));
        }
        if !quality.explains() {
            let (name, r2) = (quality.axis.name(), quality.r2);
            warn(&format!(
                "{name} is kept by --force-fit, though the pictures explain nothing of it (held-out R² {r2:.2})"
            ));
        }
    }
}
