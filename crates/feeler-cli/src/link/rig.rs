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
    experiment: String,
    /// The serial port in place of the experiment's.
    #[arg(long, conflicts_with = "drives")]
    port: Option<String>,
    /// Serve servos on an emulated bus, with the simulated world behind them, whose pictures or forces it publishes: `emulated`.
    #[arg(long, value_name = "SERVOS", value_parser = ["emulated"])]
    drives: Option<String>,
    /// Say what would be read and written, and write nothing to a servo.
    #[arg(long)]
    dry_run: bool,
    /// Ask the system for real-time priority and for memory that is never swapped out, so that servos are asked on time.
    #[arg(long)]
    real_time: bool,
    /// Seconds of the experiment in a second, the same as the hand's. Other than 1 for emulated servos alone.
    #[arg(long, default_value = "1")]
    speed: RigSpeed,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Serves servos on a bus until Ctrl-C.
#[cfg(all(feature = "drives", target_os = "linux"))]
pub fn rig(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let session = arguments
        .values
        .session(&arguments.experiment, &arguments.link)?;
    let options = feeler_rig::DrivesOptions {
        port: arguments.port.clone(),
        emulated: arguments.drives.is_some(),
        dry_run: arguments.dry_run,
        real_time: arguments.real_time,
        speed: arguments.speed,
    };
    feeler_rig::serve_drives(&session, &options, out)
}

/// Says that there is no such thing.
#[cfg(not(all(feature = "drives", target_os = "linux")))]
pub fn rig(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err(
        "this program was built without servos; build it on Linux with --features drives,link"
            .into(),
    )
}
