//! `feeler rig`

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use feeler_link::programs::RigSpeed;
use std::io::Write;

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
pub struct Arguments {
    /// The experiment whose servos to serve: a file with a table [drives], or the name of a built-in one (see `feeler list`).
    pub(super) experiment: String,
    /// The serial port in place of the experiment's.
    #[arg(long, conflicts_with = "drives")]
    pub(super) port: Option<String>,
    /// Serve servos on an emulated bus, with the simulated world behind them, whose pictures or forces it publishes: `emulated`.
    #[arg(long, value_name = "SERVOS", value_parser = ["emulated"])]
    pub(super) drives: Option<String>,
    /// Say what would be read and written, and write nothing to a servo.
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Ask the system for real-time priority and for memory that is never swapped out, so that servos are asked on time.
    #[arg(long)]
    pub(super) real_time: bool,
    /// Seconds of the experiment in a second, the same as the hand's. Other than 1 for emulated servos alone.
    #[arg(long, default_value = "1")]
    pub(super) speed: RigSpeed,
    #[command(flatten)]
    pub(super) values: ExperimentArguments,
    #[command(flatten)]
    pub(super) link: LinkArguments,
}

/// Serves servos on a bus until Ctrl-C.
#[cfg(all(feature = "drives", target_os = "linux"))]
pub fn rig(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    super::served_drives::serve(arguments, out)
}

/// Says that there is no such thing.
#[cfg(not(all(feature = "drives", target_os = "linux")))]
pub fn rig(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err(
        "this program was built without servos; build it on Linux with --features drives,link"
            .into(),
    )
}
