//! The `feeler bench` subcommand: measures latency on this computer.

use crate::{CommandError, Outcome};
use feeler_rig::{LatencyBench, measure_latency, send_readings};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    bench: Bench,
}

#[derive(Debug, clap::Subcommand)]
enum Bench {
    /// Measure the time from a tactile update to the command computed from it, between two programs on this computer, without
    /// the wait for the control period.
    Link(LinkBench),
}

#[derive(Debug, clap::Args)]
struct LinkBench {
    /// Control steps per second.
    #[arg(long, default_value = "1000", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rate: u32,
    /// Duration of the measurement (s).
    #[arg(long, default_value = "10", value_parser = clap::value_parser!(u32).range(1..=3600))]
    seconds: u32,
    /// Endpoint of the hand to send readings to: the second process of the measurement.
    #[arg(long, hide = true)]
    sensors_of: Option<String>,
}

pub fn bench(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let Bench::Link(bench) = &arguments.bench;
    match &bench.sensors_of {
        Some(hand) => send_readings(hand, bench.rate),
        None => {
            let (rate, seconds) = (bench.rate, bench.seconds);
            measure_latency(LatencyBench { rate, seconds }, out)
        }
    }
}
