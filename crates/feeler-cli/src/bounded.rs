//! Value parsers for bounded numbers on the command line.

/// Parses a number from `low` to `high` (inclusive) with the given `unit`.
///
/// # Errors
/// Returns the expected range if `text` is not a number within it.
pub fn parse_between(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (low..=high).contains(number))
        .ok_or_else(|| format!("expected {low} to {high} {unit}"))
}

/// Parses a rate of frames or samples (Hz).
///
/// # Errors
/// Returns the expected range if `text` is not a number within it.
pub fn parse_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-3, 1e5, "Hz")
}
