//! The `feeler top` subcommand: a networked rig in the terminal.

#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
mod heard;
#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
mod programs;
#[cfg(feature = "top")]
mod show;
#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
// The ROS 2 node sends orders through its own client.
#[cfg_attr(not(any(feature = "top", feature = "view")), allow(dead_code))]
pub mod watched;

#[cfg(feature = "ros2")]
pub use heard::Heard;

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

/// Shows a rig.
#[cfg(feature = "top")]
pub fn top(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    show::show(arguments, out)
}

/// Returns an error: this build has no terminal view.
#[cfg(not(feature = "top"))]
pub fn top(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    let Arguments {
        experiment,
        once: _,
        values: _,
        link: _,
    } = arguments;
    Err(format!(
        "top {experiment}: this program was built without the terminal view; build it with --features link,top"
    )
    .into())
}
