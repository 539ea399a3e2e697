//! The `feeler world` subcommand.

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use feeler_console::{Warnings, watch_for_interrupt};
use feeler_lab::experiment::SimRigServer;
use feeler_lab::experiment::rigs::linked::rig_config;
use feeler_link::programs::{RigProgram, RigSpeed};
use feeler_link::security::Right;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment whose rig is simulated: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// Speed relative to real time, the same as the hand's, or `max` for lockstep.
    ///
    /// With `max`, the simulation waits for the hand's answer in every step, and is bit-identical to `feeler run`.
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
    let rig = SimRigServer::new(experiment)?;
    let config = rig_config(experiment, arguments.speed)?;
    let network = session.connect(&[Right::Rig])?;
    let interrupted = watch_for_interrupt()?;
    let mut program = RigProgram::new(rig, &config, network)?;
    program.set_warn(Warnings::on_stderr().warn());
    let name = &experiment.config.name;
    writeln!(out, "simulating the rig of {name}; press Ctrl-C to stop")?;
    out.flush()?;
    program.run(&interrupted)?;
    writeln!(out, "{}", program.report())?;
    Ok(Outcome::Done)
}
