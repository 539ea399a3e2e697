//! The `feeler top` subcommand: a networked rig in the terminal.

#![cfg_attr(
    not(feature = "top"),
    allow(dead_code, reason = "this program has no terminal view")
)]

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment of the rig: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// Print one snapshot as text and exit, one second after the rig is found. Requires no terminal.
    #[arg(long)]
    once: bool,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Shows a running rig on the terminal until the user quits, or prints one snapshot.
#[cfg(feature = "top")]
pub fn top(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_link::security::Right;
    if !arguments.once {
        let check = feeler_watch::View::check_terminal();
        check.map_err(|e| format!("{e}; or use --once to print a snapshot"))?;
    }
    let session = arguments
        .values
        .session(&arguments.experiment, &arguments.link)?;
    let network = session.connect(&[Right::Order, Right::Watch])?;
    feeler_watch::show_rig(
        &session.experiment,
        &session.name,
        network,
        arguments.once,
        out,
    )
}

/// Returns an error: this build has no terminal view.
#[cfg(not(feature = "top"))]
pub fn top(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = &arguments.experiment;
    Err(format!(
        "top {experiment}: this program was built without the terminal view; build it with --features link,top"
    )
    .into())
}
