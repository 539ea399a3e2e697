//! The `--flush-interval` option.

use super::bounded::parse_between;
use feeler_record::FLUSH_INTERVAL;

/// Interval at which a recording is flushed.
#[derive(Debug, Clone, clap::Args)]
pub struct FlushArguments {
    /// Flush the recording at least this often, in seconds of the run's time. At most this much is lost if the
    /// program is killed.
    #[arg(long, value_name = "S", default_value_t = FLUSH_INTERVAL, value_parser = parse_interval)]
    pub flush_interval: f64,
}

fn parse_interval(text: &str) -> Result<f64, String> {
    parse_between(text, 0.01, 3600.0, "s")
}
