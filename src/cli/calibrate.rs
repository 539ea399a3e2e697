//! `feeler calibrate`

use super::{CommandError, Outcome};
use crate::config::Experiment;
use crate::sensor::calibration_fit::ModelChoice;
use crate::sensor::calibration_report::CalibrationReport;
use crate::sim::calibration_bench::{CalibrationBenchConfig, calibrate_simulated};
use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Load the simulated fingertip of an experiment (the only kind of fingertip there is so far).
    #[arg(long, required = true)]
    simulated: bool,
    /// The experiment whose fingertip it is: a file, or the name of a built-in experiment.
    #[arg(default_value = "cap-closing")]
    experiment: String,
    /// Where to write the calibration.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Seed of the loads' order and of the camera's noise.
    #[arg(long, default_value_t = CalibrationBenchConfig::default().seed)]
    seed: u64,
    /// Which model to fit: the paper's (separable), the one that knows how a column tilts (coupled),
    /// or the one that predicts loads better which it has not been fitted to (auto).
    #[arg(long, value_parser = model, default_value = "auto", value_name = "MODEL")]
    model: ModelChoice,
}

/// The model of this name.
fn model(name: &str) -> Result<ModelChoice, String> {
    match name {
        "separable" => Ok(ModelChoice::Separable),
        "coupled" => Ok(ModelChoice::Coupled),
        "auto" => Ok(ModelChoice::Auto),
        _ => Err("expected separable, coupled or auto".into()),
    }
}

pub fn calibrate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let config = Experiment::load(&arguments.experiment, &[])?.config;
    let bench = CalibrationBenchConfig {
        seed: arguments.seed,
        model: arguments.model,
        ..CalibrationBenchConfig::default()
    };
    // Written aside and moved when it is whole; opened first, for calibrating takes its time.
    let output = &arguments.output;
    let mut part = output.clone().into_os_string();
    part.push(".part");
    let part = PathBuf::from(part);
    let failed = |e: std::io::Error| {
        let output = output.display();
        format!("--output {output}: {e}; expected a file in a folder that can be written to")
    };
    let mut file = File::create(&part).map_err(failed)?;
    let made = calibrate_simulated(&config.sensor.fingertip, &config.sim.optics, &bench)
        .map_err(CommandError::from)
        .and_then(|calibration| {
            let text = calibration.to_toml()?;
            file.write_all(text.as_bytes()).map_err(failed)?;
            fs::rename(&part, output).map_err(failed)?;
            Ok(calibration)
        });
    let calibration = made.inspect_err(|_| {
        // What is left of it is of no use to anyone.
        let _ = fs::remove_file(&part);
    })?;
    writeln!(out, "{}", CalibrationReport::new(&calibration))?;
    writeln!(out, "{}", output.display())?;
    Ok(Outcome::Done)
}
