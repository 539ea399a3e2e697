//! Extent of a test, set by environment variables.

/// Returns the number in the environment variable `variable`, or `default` if it is not set.
pub fn how_many(variable: &str, default: usize) -> usize {
    let said = std::env::var(variable).ok();
    said.map_or(default, |said| {
        let number = said.parse();
        number.unwrap_or_else(|_| panic!("{variable}: expected a number, got {said:?}"))
    })
}
