//! The `feeler rig` subcommand.

#![cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]

use super::{ExperimentArguments, LinkArguments};
use crate::{CommandError, Outcome};
use feeler_link::programs::RigSpeed;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment whose servos are served: a file with a table [drives], or the name of a built-in one (see `feeler
    /// list`).
    experiment: String,
    /// Serial port, overriding the experiment's.
    #[arg(long, conflicts_with = "drives")]
    port: Option<String>,
    /// Serve an emulated servo bus connected to the simulated world, and publish the world's images or forces.
    #[arg(long, value_name = "SERVOS", value_parser = ["emulated"])]
    drives: Option<String>,
    /// Print the planned reads and writes, and write nothing to the servos.
    #[arg(long)]
    dry_run: bool,
    /// Request real-time priority and locked memory, so that servos are polled on time.
    #[arg(long)]
    real_time: bool,
    /// Speed relative to real time, the same as the hand's. Only emulated servos support values other than 1.
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

/// Returns an error: this build has no servos.
#[cfg(not(all(feature = "drives", target_os = "linux")))]
pub fn rig(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err(
        "this program was built without servos; build it on Linux with --features drives,link"
            .into(),
    )
}
