//! `feeler top`: a running rig of several programs on the terminal.

#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
mod heard;
#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
mod programs;
#[cfg(feature = "top")]
mod show;
#[cfg(any(feature = "top", feature = "view", feature = "ros2"))]
// The node of ROS 2 gives its orders in a way of its own.
#[cfg_attr(not(any(feature = "top", feature = "view")), allow(dead_code))]
pub mod watched;

#[cfg(feature = "ros2")]
pub use heard::Heard;

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment of the rig: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// Print one picture as text, a second after the rig was first heard; no terminal is needed.
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

/// Says that there is nothing to show it on.
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
