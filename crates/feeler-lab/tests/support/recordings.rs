//! Recordings of real sensors, which are no part of the repository.

#![allow(dead_code, reason = "not every test program needs all of it")]

use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of the recordings called `set`, for the test called `test`: in `FEELER_DATA`, or in `../shared/data` beside the repository.
/// A relative path counts from the repository. `None`, said on stderr, if it is not there.
///
/// # Panics
/// Where nothing may be skipped, if other recordings are there, but not these.
pub fn recordings(set: &str, test: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("FEELER_DATA").unwrap_or("../shared/data".into());
    let data = root.join(data);
    let path = data.join(set);
    if path.is_dir() {
        return Some(path);
    }
    let missing = format!("there is no {}; set FEELER_DATA", path.display());
    if data.is_dir() {
        cannot(test, &missing);
    } else {
        // They are no part of the repository, so that it is no failure where all else is required.
        tell(test, &missing);
    }
    None
}

/// Says that the test called `test` is skipped, though its recordings are there, as `missing`.
///
/// # Panics
/// Where nothing may be skipped: in CI (`CI=true`, or `FEELER_REQUIRE_ALL`).
pub fn cannot(test: &str, missing: &str) {
    let set = |name: &str, not: &[&str]| {
        std::env::var(name).is_ok_and(|value| !not.contains(&value.as_str()))
    };
    let required = set("CI", &["", "0", "false"]) || set("FEELER_REQUIRE_ALL", &["0"]);
    assert!(!required, "{test} may not be skipped here, but {missing}");
    tell(test, missing);
}

fn tell(test: &str, missing: &str) {
    // Not `eprintln!`, which the harness keeps to itself where a test passes.
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {missing}");
}
