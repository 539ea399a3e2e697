//! `feeler urdf`

use super::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::geometries;
use feeler_record::urdf::{FingerModel, urdf};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment.
    experiment: String,
    /// Describe the hand with this value set, as in hand.finger.0.phi1_deg=10.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

/// Prints the hand of an experiment as URDF.
pub fn print(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    let config = &experiment.config;
    let geometries = geometries(config)?;
    let model = |(finger, geometry)| FingerModel {
        geometry,
        dome_radius: config.sensor.fingertip(finger).layout.dome_radius,
    };
    let fingers: Vec<_> = geometries.iter().enumerate().map(model).collect();
    write!(out, "{}", urdf(&config.name, &fingers)?)?;
    Ok(Outcome::Done)
}
