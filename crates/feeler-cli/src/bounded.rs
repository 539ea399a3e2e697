//! Numbers on the command line that have bounds.

/// A number within `low` and `high`, both included, of a `unit`.
///
/// # Errors
/// Which numbers were expected.
pub fn parse_between(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (low..=high).contains(number))
        .ok_or_else(|| format!("expected {low} to {high} {unit}"))
}

/// Pictures or samples per second, Hz.
///
/// # Errors
/// Which rates were expected.
pub fn parse_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-3, 1e5, "Hz")
}
