//! `feeler drives`

#[cfg(all(feature = "drives", target_os = "linux"))]
mod bus_log;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod emulate;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod home;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod jog;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod scan;

use super::{CommandError, Outcome};
use crate::options::Overwrite;
use crate::options::parse_between;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Emulate a bus of servos on a pseudo-terminal, whose path it prints, until Ctrl-C.
    Emulate(EmulateArguments),
    /// List the servos that answer on a bus. Writes nothing to them.
    Scan(ScanArguments),
    /// Compare the servos of an experiment with its [drives]: models, settings, health, where the joints are. Writes nothing to them.
    Check(RigArguments),
    /// Find the homing offsets that make the joints' present posture the one they are said to be in. Writes nothing to the servos.
    Home(HomeArguments),
    /// Turn one joint by a small angle, slowly, and switch all torque off again.
    Jog(JogArguments),
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
struct EmulateArguments {
    /// The experiment whose servos and simulated world to emulate; without it, servos that move nothing but themselves.
    experiment: Option<String>,
    /// Set any value of the experiment, as in drives.baud_rate=57600.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Without an experiment: what the servos speak.
    #[arg(long, value_parser = ["dynamixel", "feetech"], conflicts_with = "experiment", default_value = "dynamixel")]
    protocol: String,
    /// Without an experiment: how many servos there are, with ids from 1 on.
    #[arg(long, value_name = "COUNT", conflicts_with = "experiment", default_value = "6", value_parser = clap::value_parser!(u8).range(1..=15))]
    servos: u8,
    /// Without an experiment: bits a second, for the time that bytes take.
    #[arg(long, value_name = "BITS", conflicts_with = "experiment", default_value = "1000000", value_parser = clap::value_parser!(u32).range(9600..=10_000_000))]
    baud_rate: u32,
    /// What goes wrong from the start, as in silent=3, flip-bytes=0.01, echo; several are allowed. `-`: what is typed later on, a line
    /// each.
    #[arg(long = "fault", value_name = "FAULT")]
    faults: Vec<String>,
    /// Seconds of the servos' time in a second, 0.01 to 1: a master on a busy computer has more time for its answers.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = parse_speed)]
    speed: f64,
    /// Write what is said on the bus to this table, a row for each packet: time (s), who sends it, id, instruction, bytes in hexadecimal
    /// (parameters of an instruction, the whole of an answer).
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
struct ScanArguments {
    /// The serial port, e.g. /dev/ttyUSB0.
    port: String,
    /// What the servos speak; without it, both are tried.
    #[arg(long, value_parser = ["dynamixel", "feetech"])]
    protocol: Option<String>,
    /// Bits a second; without it, those that servos are usually set to, one after the other.
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(9600..=10_000_000))]
    baud_rate: Option<u32>,
    /// Largest id to ask.
    #[arg(long, value_name = "ID", default_value = "30", value_parser = clap::value_parser!(u8).range(0..=252))]
    largest_id: u8,
    /// How long to wait for a servo that may not be there; two turns of a USB adapter's usual 16 ms, unless told.
    #[arg(long, value_name = "S", default_value = "0.035", value_parser = parse_timeout)]
    timeout: f64,
    /// Say what would be asked, and open no port.
    #[arg(long)]
    dry_run: bool,
}

fn parse_timeout(text: &str) -> Result<f64, String> {
    parse_between(text, 0.001, 10.0, "s")
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
pub(super) struct RigArguments {
    /// An experiment file with a table [drives].
    experiment: String,
    /// Set any value of the experiment, as in drives.port=/dev/ttyUSB1.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// The serial port in place of the experiment's.
    #[arg(long)]
    port: Option<String>,
    /// Say what would be read and written, and write nothing to a servo.
    #[arg(long)]
    dry_run: bool,
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
struct HomeArguments {
    #[command(flatten)]
    rig: RigArguments,
    /// The joint angles that the hand stands at, finger by finger, degrees; without them, those of the task's home.
    #[arg(
        long,
        value_name = "DEG,DEG,...",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    at: Vec<f64>,
    /// Write the experiment with the new offsets here.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program has no servos")
)]
struct JogArguments {
    #[command(flatten)]
    rig: RigArguments,
    /// The finger, from 0.
    #[arg(long)]
    finger: usize,
    /// The joint: 1 for theta1, to 3.
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=3))]
    joint: u8,
    /// By how much to turn it, degrees: at most 10 in either direction.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    by: f64,
    /// How fast, degrees a second: at most 10.
    #[arg(long, value_name = "DEG_PER_S", default_value = "3")]
    speed: f64,
}

#[cfg(all(feature = "drives", target_os = "linux"))]
impl RigArguments {
    /// Loads the experiment and its servos.
    fn load(&self) -> Result<feeler_rig::ServoRig, CommandError> {
        let experiment = feeler_lab::config::Experiment::load(&self.experiment, &self.settings)?;
        feeler_rig::ServoRig::new(experiment, self.port.as_deref())
    }
}

/// How fast the time of emulated servos goes.
fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|s| (0.01..=1.0).contains(s));
    speed.ok_or_else(|| "expected 0.01 to 1".into())
}

#[cfg(all(feature = "drives", target_os = "linux"))]
pub fn drives(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.command {
        Command::Emulate(arguments) => emulate::emulate(arguments, out),
        Command::Scan(arguments) => scan::scan(arguments, out),
        Command::Check(arguments) => {
            feeler_rig::check_servos(&arguments.load()?, arguments.dry_run, out)
        }
        Command::Home(arguments) => home::home(arguments, out),
        Command::Jog(arguments) => jog::jog(arguments, out),
    }
}

#[cfg(not(all(feature = "drives", target_os = "linux")))]
pub fn drives(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err("this program was built without servos; build it on Linux with --features drives".into())
}
