//! Skipping of tests with optional requirements.

#![allow(dead_code, reason = "not every test program needs all of it")]

/// Reports on stderr that the current test is skipped for the reason `missing`.
///
/// # Panics
/// If `FEELER_REQUIRE_ALL` is set.
pub fn skipped(missing: &str) {
    let required = std::env::var_os("FEELER_REQUIRE_ALL").is_some_and(|value| value != "0");
    assert!(!required, "FEELER_REQUIRE_ALL is set, but {missing}");
    tell(missing);
}

/// Like [`skipped`], but for a missing permission, which no installation provides: never panics.
pub fn not_permitted(missing: &str) {
    tell(missing);
}

fn tell(missing: &str) {
    use std::io::Write;
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    // The harness captures the output of `eprintln!` if a test passes.
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {missing}");
}
