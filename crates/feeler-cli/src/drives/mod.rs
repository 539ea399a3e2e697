//! The `feeler drives` subcommand.

#![cfg_attr(
    not(feature = "drives"),
    allow(dead_code, reason = "this program has no servos")
)]

#[cfg(all(feature = "drives", target_os = "linux"))]
mod bus_log;
#[cfg_attr(not(target_os = "linux"), path = "emulate/elsewhere.rs")]
#[cfg(feature = "drives")]
mod emulate;
#[cfg(feature = "drives")]
mod home;
#[cfg(feature = "drives")]
mod identify_current;
#[cfg(feature = "drives")]
mod jog;
#[cfg(feature = "drives")]
mod output;
#[cfg(feature = "drives")]
mod scan;

use super::{CommandError, Outcome};
use crate::options::{Overwrite, parse_between};
use std::io::Write;
use std::path::PathBuf;

/// Names of the servo protocols. The help lists them even without the feature `drives`.
const PROTOCOLS: [&str; 3] = ["dynamixel", "feetech", "feetech-scs"];

#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Emulate a servo bus on a pseudo-terminal until Ctrl-C, and print its path.
    Emulate(EmulateArguments),
    /// List the servos on a bus. Writes nothing to them.
    Scan(ScanArguments),
    /// Compare an experiment's servos with its [drives]: models, settings, velocity limits, health, joint angles. Writes
    /// nothing to them.
    Check(RigArguments),
    /// Compute the homing offsets from the present posture. Writes nothing to the servos.
    Home(HomeArguments),
    /// Identify the torque of a joint by its motor's current, from slow sweeps under known loads.
    IdentifyCurrent(IdentifyArguments),
    /// Move one joint slowly by a small angle or distance, then disable torque.
    Jog(JogArguments),
}

#[derive(Debug, clap::Args)]
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    allow(dead_code, reason = "this program emulates no servos")
)]
struct EmulateArguments {
    /// Experiment whose servos and simulated world are emulated [default: servos without a load]
    experiment: Option<String>,
    /// Override a value of the experiment, e.g. drives.baud_rate=57600. Requires EXPERIMENT. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "experiment")]
    settings: Vec<String>,
    /// Protocol of the servos if no experiment is given.
    #[arg(long, value_parser = PROTOCOLS, conflicts_with = "experiment", default_value = "dynamixel")]
    protocol: String,
    /// Number of servos (ids from 1) if no experiment is given.
    #[arg(long, value_name = "COUNT", conflicts_with = "experiment", default_value = "6", value_parser = clap::value_parser!(u8).range(1..=15))]
    servos: u8,
    /// Baud rate that determines transfer times if no experiment is given.
    #[arg(long, value_name = "BITS", conflicts_with = "experiment", default_value = "1000000", value_parser = clap::value_parser!(u32).range(9600..=10_000_000))]
    baud_rate: u32,
    /// Fault to inject from the start, e.g. silent=3, flip-bytes=0.01, echo. Repeatable.
    ///
    /// `-` reads faults from standard input, one per line.
    #[arg(long = "fault", value_name = "FAULT")]
    faults: Vec<String>,
    /// Speed of the servos' clock relative to real time, 0.01 to 1.
    ///
    /// Values below 1 give a master on a busy computer more time per reply.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = parse_speed)]
    speed: f64,
    /// Log the bus traffic to this table.
    ///
    /// One row per packet: time (s), sender, id, instruction, bytes in hexadecimal (the parameters of an instruction,
    /// the whole of a reply).
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[derive(Debug, clap::Args)]
struct ScanArguments {
    /// Serial port, e.g. /dev/ttyUSB0.
    port: String,
    /// Protocol of the servos; `feetech` also finds `feetech-scs` servos [default: try both]
    #[arg(long, value_parser = ["dynamixel", "feetech"])]
    protocol: Option<String>,
    /// Baud rate of the bus [default: try the usual ones]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(9600..=10_000_000))]
    baud_rate: Option<u32>,
    /// Largest id to scan.
    #[arg(long, value_name = "ID", default_value = "30", value_parser = clap::value_parser!(u8).range(0..=252))]
    largest_id: u8,
    /// Time to wait for the reply of a servo (s).
    ///
    /// The default is twice the usual 16 ms latency of a USB adapter.
    #[arg(long, value_name = "S", default_value = "0.035", value_parser = parse_timeout)]
    timeout: f64,
    /// Print the queries without opening the port.
    #[arg(long)]
    dry_run: bool,
}

fn parse_timeout(text: &str) -> Result<f64, String> {
    parse_between(text, 0.001, 10.0, "s")
}

#[derive(Debug, clap::Args)]
pub(super) struct RigArguments {
    /// Experiment file with a table [drives].
    experiment: String,
    /// Override an experiment value, e.g. drives.port=/dev/ttyUSB1. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Serial port, overriding the experiment's.
    #[arg(long)]
    port: Option<String>,
    /// Print the planned reads and writes, and write nothing to the servos.
    #[arg(long)]
    dry_run: bool,
}

#[derive(Debug, clap::Args)]
struct HomeArguments {
    #[command(flatten)]
    rig: RigArguments,
    /// Present joint positions (deg; mm of prismatic joints), finger by finger [default: the task's home posture]
    #[arg(
        long,
        value_name = "DEG,DEG,...",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    at: Vec<f64>,
    /// Write the experiment with the new offsets to this file.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

/// Finger and joint to move.
#[derive(Debug, Clone, Copy, clap::Args)]
struct JointArguments {
    /// Index of the finger, from 0.
    #[arg(long)]
    finger: usize,
    /// Joint to move, counted from the base: 1 for theta1, 2 for theta2 and so on.
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=7))]
    joint: u8,
}

impl JointArguments {
    /// Indices of the finger and of its joint, from 0.
    #[cfg(feature = "drives")]
    fn place(&self) -> (usize, usize) {
        (self.finger, usize::from(self.joint) - 1)
    }
}

#[derive(Debug, clap::Args)]
struct JogArguments {
    #[command(flatten)]
    rig: RigArguments,
    #[command(flatten)]
    joint: JointArguments,
    /// Angle or distance to move by (deg; mm for a prismatic joint), at most 10 in either direction.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    by: f64,
    /// Speed (deg/s; mm/s for a prismatic joint), at most 10; less if the servo moves another joint faster.
    #[arg(long, value_name = "DEG_PER_S", default_value = "3")]
    speed: f64,
}

#[derive(Debug, clap::Args)]
struct IdentifyArguments {
    #[command(flatten)]
    rig: RigArguments,
    #[command(flatten)]
    joint: JointArguments,
    /// Torques of the loads against positive motion of the joint (N m; N for a prismatic joint), e.g. 0,0.03,0.06.
    ///
    /// Before each load, the command waits for Enter. A weight on a thread over a pulley on the joint's axis exerts a
    /// constant torque, and so does one on a horizontal link, if the sweep is small.
    #[arg(
        long,
        value_name = "TORQUE,TORQUE,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        required = true
    )]
    loads: Vec<f64>,
    /// Sweep to either side (deg; mm for a prismatic joint), at most 10.
    #[arg(long, value_name = "DEG", default_value = "4")]
    by: f64,
    /// Speed (deg/s; mm/s for a prismatic joint), at most 10; less if the servo moves another joint faster.
    #[arg(long, value_name = "DEG_PER_S", default_value = "6")]
    speed: f64,
    /// Number of sweeps in each direction, per load.
    #[arg(long, value_name = "COUNT", default_value = "3", value_parser = clap::value_parser!(u8).range(2..=50))]
    sweeps: u8,
    /// Write the experiment with the calibration to this file.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[cfg(feature = "drives")]
impl RigArguments {
    /// Loads the experiment and its servos.
    fn load(&self) -> Result<feeler_rig::ServoRig, CommandError> {
        let experiment = feeler_lab::config::Experiment::load(&self.experiment, &self.settings)?;
        feeler_rig::ServoRig::new(experiment, self.port.as_deref())
    }
}

/// Parses the speed of the emulated servos' clock.
fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|s| (0.01..=1.0).contains(s));
    speed.ok_or_else(|| "expected 0.01 to 1".into())
}

#[cfg(feature = "drives")]
pub fn drives(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.command {
        Command::Emulate(arguments) => emulate::emulate(arguments, out),
        Command::Scan(arguments) => scan::scan(arguments, out),
        Command::Check(arguments) => {
            feeler_rig::check_servos(&arguments.load()?, arguments.dry_run, out)
        }
        Command::Home(arguments) => home::home(arguments, out),
        Command::IdentifyCurrent(arguments) => identify_current::identify(arguments, out),
        Command::Jog(arguments) => jog::jog(arguments, out),
    }
}

#[cfg(not(feature = "drives"))]
pub fn drives(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err("this program was built without servos; build it with --features drives".into())
}
