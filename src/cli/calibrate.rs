//! `feeler calibrate`

use super::{CommandError, Outcome};
use crate::config::Experiment;
use crate::sensor::calibration_report::CalibrationReport;
use crate::sim::calibration_bench::{CalibrationBenchConfig, calibrate_simulated};
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
}

pub fn calibrate(arguments: &Arguments) -> Result<Outcome, CommandError> {
    let config = Experiment::load(&arguments.experiment, &[])?.config;
    let bench = CalibrationBenchConfig {
        seed: arguments.seed,
        ..CalibrationBenchConfig::default()
    };
    let calibration = calibrate_simulated(&config.sensor.fingertip, &config.sim.optics, &bench)?;
    println!("{}", CalibrationReport::new(&calibration));
    std::fs::write(&arguments.output, calibration.to_toml()?)
        .map_err(|e| format!("{}: {e}", arguments.output.display()))?;
    println!("{}", arguments.output.display());
    Ok(Outcome::Done)
}
