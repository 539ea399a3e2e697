//! `feeler world`

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use feeler_console::Warnings;
use feeler_console::watch_for_interrupt;
use feeler_lab::experiment::linked::rig_config;
use feeler_lab::experiment::played_rig::PlayedRig;
use feeler_link::programs::{RigProgram, RigSpeed};
use feeler_link::right::Right;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment whose rig to simulate: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// Seconds of the experiment in a second, the same as the hand's; `max` waits for the hand's answer to every step instead, and
    /// then the cap closes bit for bit as in `feeler run`.
    #[arg(long, default_value = "1")]
    speed: RigSpeed,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Simulates the rig until Ctrl-C.
pub fn world(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let session = arguments
        .values
        .session(&arguments.experiment, &arguments.link)?;
    let experiment = &session.experiment;
    let rig = PlayedRig::new(experiment)?;
    let config = rig_config(experiment, arguments.speed)?;
    let network = session.connect(&[Right::Rig])?;
    let interrupted = watch_for_interrupt()?;
    let mut program = RigProgram::new(rig, &config, network)?;
    program.set_warn(Warnings::on_stderr().warn());
    let name = &experiment.config.name;
    writeln!(out, "playing the rig of {name}; Ctrl-C ends it")?;
    out.flush()?;
    program.run(&interrupted)?;
    writeln!(out, "{}", program.report())?;
    Ok(Outcome::Done)
}
