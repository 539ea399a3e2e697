//! The `feeler urdf` subcommand.

use super::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::run_facts;
use feeler_record::viewers::urdf;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment.
    experiment: String,
    /// Override an experiment value, e.g. hand.finger.0.phi1_deg=10.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

/// Prints an experiment's hand and the solids around it as URDF.
pub fn print(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    let facts = run_facts(&experiment.config)?;
    let description = urdf(&facts.experiment, &facts.hand, &facts.solids)?;
    write!(out, "{description}")?;
    Ok(Outcome::Done)
}
