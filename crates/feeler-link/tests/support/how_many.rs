//! Extent of a test, set by environment variables.

#![allow(dead_code, reason = "not every test program needs all of it")]

/// Returns `true` if `FEELER_LONG_TESTS` is set, but not to 0: tests then use all of their data and time.
pub fn is_long() -> bool {
    std::env::var_os("FEELER_LONG_TESTS").is_some_and(|value| value != "0")
}

/// Returns the number in the environment variable `variable`, or `default` if it is not set.
pub fn how_many(variable: &str, default: usize) -> usize {
    let said = std::env::var(variable).ok();
    said.map_or(default, |said| {
        let number = said.parse();
        number.unwrap_or_else(|_| panic!("{variable}: expected a number, got {said:?}"))
    })
}
