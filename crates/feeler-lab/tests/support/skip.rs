//! Tests that need what not every computer has.

#![allow(dead_code, reason = "not every test program needs all of it")]

/// Says on stderr, past the test harness, that a test is skipped as `missing` is not there; fails where
/// `FEELER_REQUIRE_ALL` is set.
pub fn skipped(missing: &str) {
    let required = std::env::var_os("FEELER_REQUIRE_ALL").is_some_and(|value| value != "0");
    assert!(!required, "FEELER_REQUIRE_ALL is set, but {missing}");
    tell(missing);
}

/// The same for a right that a system may withhold: no installation gives it, so nothing fails.
pub fn not_permitted(missing: &str) {
    tell(missing);
}

fn tell(missing: &str) {
    use std::io::Write;
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    // Not `eprintln!`, which the harness keeps to itself where a test passes.
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {missing}");
}
