//! Recordings of real sensors, stored outside the repository.

#![allow(dead_code, reason = "not every test program needs all of it")]

use std::io::Write;
use std::path::{Path, PathBuf};

/// Folder of the recordings called `set`, in `FEELER_DATA` or by default in `../shared/data` next to the repository.
///
/// Relative paths start at the repository. If the folder is missing, reports on stderr that `test` is skipped and
/// returns `None`.
///
/// # Panics
/// If tests must not be skipped and other recordings are present but not these.
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
        // Recordings are not in the repository, so their absence is never a failure.
        tell(test, &missing);
    }
    None
}

/// Reports that `test` is skipped for the reason `missing` although its recordings are present.
///
/// # Panics
/// If tests must not be skipped: in CI (`CI=true`) or with `FEELER_REQUIRE_ALL`.
pub fn cannot(test: &str, missing: &str) {
    let set = |name: &str, not: &[&str]| {
        std::env::var(name).is_ok_and(|value| !not.contains(&value.as_str()))
    };
    let required = set("CI", &["", "0", "false"]) || set("FEELER_REQUIRE_ALL", &["0"]);
    assert!(!required, "{test} must not be skipped here, but {missing}");
    tell(test, missing);
}

fn tell(test: &str, missing: &str) {
    // The harness captures the output of `eprintln!` if a test passes.
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {missing}");
}
