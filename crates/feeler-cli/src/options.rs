//! Options that several commands share, and their values.

use feeler_record::FLUSH_INTERVAL;

/// Option to replace existing files.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Overwrite {
    /// Overwrite existing output files. Input files are never overwritten.
    #[arg(long)]
    pub force: bool,
}

/// Output format of a command that prints its result.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Json {
    /// Print one JSON object instead of text, for other programs (docs/json.md).
    #[arg(long)]
    pub json: bool,
}

/// Options that change values of the experiment.
#[derive(Debug, Clone, clap::Args)]
pub struct SettingArguments {
    /// Random seed.
    #[arg(long, value_parser = crate::experiments::trials::parse_seed)]
    pub seed: Option<u64>,
    /// Source of forces: `image` (rendered camera images) or `direct` (simulated forces plus noise).
    #[arg(long, value_parser = ["image", "direct"])]
    pub sensing: Option<String>,
    /// Override an experiment value, e.g. control.slip_threshold=2.5. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
}

impl SettingArguments {
    /// Returns the settings given on the command line; dedicated flags come last.
    pub fn settings(&self) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("seed={seed}"));
        let sensing = self.sensing.as_ref().map(|s| format!("sensing={s}"));
        let named = seed.into_iter().chain(sensing);
        self.settings.iter().cloned().chain(named).collect()
    }
}

/// Interval at which a recording is written to disk.
#[derive(Debug, Clone, clap::Args)]
pub struct FlushArguments {
    /// Write the recording to disk at least every S seconds of the run's time: the most that is lost if the program is
    /// killed.
    #[arg(long, value_name = "S", default_value_t = FLUSH_INTERVAL, value_parser = parse_interval)]
    pub flush_interval: f64,
}

fn parse_interval(text: &str) -> Result<f64, String> {
    parse_between(text, 0.01, 3600.0, "s")
}

/// Parses a number from `low` to `high` inclusive, in `unit`.
///
/// # Errors
/// If it is not a number or out of range; the message states the range.
pub fn parse_between(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (low..=high).contains(number))
        .ok_or_else(|| format!("expected {low} to {high} {unit}"))
}

/// Parses a number greater than 0.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| format!("expected a number greater than 0, got {text}"))
}

/// Parses a rate of images or samples, Hz.
///
/// # Errors
/// If it is out of range; the message states the range.
pub fn parse_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-3, 1e5, "Hz")
}
