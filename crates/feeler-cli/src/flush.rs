//! How much of a recording is lost when the program is killed.

use super::bounded::parse_between;
use feeler_record::FLUSH_INTERVAL;

/// How often a recording is handed to the system.
#[derive(Debug, Clone, clap::Args)]
pub struct FlushArguments {
    /// Hand the recording to the system at least once in so many seconds of the run's time: what is lost at most when
    /// the program is killed.
    #[arg(long, value_name = "S", default_value_t = FLUSH_INTERVAL, value_parser = parse_interval)]
    pub flush_interval: f64,
}

fn parse_interval(text: &str) -> Result<f64, String> {
    parse_between(text, 0.01, 3600.0, "s")
}
