//! How much of a test is done.

/// The number that the environment's `variable` says, or `default`.
pub fn how_many(variable: &str, default: usize) -> usize {
    let said = std::env::var(variable).ok();
    said.map_or(default, |said| {
        let number = said.parse();
        number.unwrap_or_else(|_| panic!("{variable}: a number expected, {said:?} found"))
    })
}
