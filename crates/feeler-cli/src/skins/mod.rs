//! The `feeler skins` subcommand.

#[cfg_attr(not(target_os = "linux"), path = "emulate/elsewhere.rs")]
mod emulate;
mod list;

use super::{CommandError, Outcome};
use crate::options::{Overwrite, parse_between, parse_positive};
use feeler_sensing::{SkinRecordOptions, record_skin};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Serial ports to look at [default: all USB serial ports]
    ///
    /// Listens on each port. If nothing arrives, sends requests that PaXini modules answer and that change nothing.
    #[arg(value_name = "PORT")]
    ports: Vec<String>,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Emulate a skin on a pseudo-terminal until Ctrl-C, and print its path.
    Emulate(EmulateArguments),
    /// Record the raw readings of a skin as a table for `feeler sense` and `feeler calibrate`.
    Record(RecordArguments),
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(target_os = "linux"),
    allow(dead_code, reason = "this program emulates no skins")
)]
struct EmulateArguments {
    /// Layout with a protocol: a file or a built-in one (see `feeler list`).
    #[arg(value_name = "LAYOUT")]
    taxels: String,
    /// Frames per second; PaXini modules respond to requests instead.
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = parse_emulated_rate)]
    rate: f64,
    /// Symbolic link to the port. Removed while the skin is unplugged; points to the new port afterwards.
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// Load, magnetic field or fault to emulate from the start, e.g. press=200, field=0,0,50, lose-bytes=0.001,
    /// unplug=2. Repeatable.
    ///
    /// `-` reads events from standard input, one per line.
    #[arg(long = "event", value_name = "EVENT", allow_hyphen_values = true)]
    events: Vec<String>,
}

#[derive(Debug, clap::Args)]
struct RecordArguments {
    /// Serial port, e.g. /dev/ttyACM0.
    port: String,
    /// Layout of the skin: a file or a built-in one (see `feeler list`).
    #[arg(long, value_name = "LAYOUT")]
    taxels: String,
    /// Duration (s) [default: until Ctrl-C]
    #[arg(long, value_name = "S", value_parser = parse_positive)]
    seconds: Option<f64>,
    /// Table to write.
    #[arg(short, long, value_name = "FILE.csv")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

fn parse_emulated_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 0.1, 2000.0, "Hz")
}

/// Lists, emulates or records skins.
pub fn skins(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.command {
        None => list::list(&arguments.ports, out),
        Some(Command::Emulate(arguments)) => emulate::emulate(arguments, out),
        Some(Command::Record(arguments)) => record_skin(&SkinRecordOptions {
            port: arguments.port.clone(),
            taxels: arguments.taxels.clone(),
            seconds: arguments.seconds,
            output: arguments.output.clone(),
            force: arguments.overwrite.force,
        }),
    }
}
