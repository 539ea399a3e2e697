//! `feeler check`

use super::{CommandError, Outcome};
use crate::config::Experiment;
use crate::experiment::Session;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment.
    experiment: String,
    /// Check it with this value set, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

pub fn check(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    // Building everything checks what only the whole can tell: reach, sight, calibration.
    let session = Session::new(&experiment)?;
    let config = &experiment.config;
    writeln!(
        out,
        "{}: good ({}; {} fingers of {} elements, {} strokes)",
        arguments.experiment,
        config.name,
        config.hand.finger.len(),
        session.layout().elements.len(),
        config.task.strokes,
    )?;
    Ok(Outcome::Done)
}
