//! Feeds the corpora of the fuzz targets to what the targets run, without cargo-fuzz.

#[path = "../fuzz/src/bodies.rs"]
mod bodies;

use std::path::Path;

/// Feeds every file of a target's corpus to it; at least one must be sound.
fn feed(target: &str, body: fn(&[u8]) -> bool) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(target);
    let files = std::fs::read_dir(&corpus).expect("the target's corpus");
    let sound = files
        .map(|file| std::fs::read(file.expect("a corpus file").path()).expect("its bytes"))
        .filter(|bytes| body(bytes))
        .count();
    assert!(sound > 0, "no file of {} is sound", corpus.display());
}

#[test]
fn layouts() {
    feed("layout", bodies::layout);
}

#[test]
fn calibrations() {
    feed("calibration", bodies::calibration);
}

#[test]
fn loads() {
    feed("loads", bodies::loads);
}

#[test]
fn pictures() {
    feed("picture", bodies::picture);
}

#[test]
fn experiments() {
    feed("experiment", bodies::experiment);
}

#[test]
fn recordings() {
    feed("recording", bodies::recording);
}
