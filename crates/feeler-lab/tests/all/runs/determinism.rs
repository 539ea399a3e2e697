//! A run's digest depends only on its seed and settings.

use crate::whole_runs::{folder, run, run_as};
use feeler_lab::experiment::{Pictures, Session};
use std::thread;

fn settings(sensing: &str, seed: u64, seconds: f64) -> [String; 3] {
    [
        format!("sensing={sensing}"),
        format!("seed={seed}"),
        format!("time_limit={seconds}"),
    ]
}

/// Digest of a run of `seconds` whose cameras render only sensed pixels.
fn digest(sensing: &str, seed: u64, seconds: f64, name: &str) -> String {
    let folder = folder(&format!("determinism-{sensing}-{seed}-{name}"));
    let settings = settings(sensing, seed, seconds);
    run(&settings, Pictures::Sensed, &folder).to_string()
}

/// Compares the digests of a run, its repetition, a run with complete images, a run with parallel sensors, and three
/// concurrent runs, one with another seed.
fn check(sensing: &'static str, seconds: f64) {
    let alone = digest(sensing, 1, seconds, "alone");
    assert_eq!(digest(sensing, 1, seconds, "again"), alone);
    for pictures in [Pictures::Whole, Pictures::Sensed] {
        let folder = folder(&format!("determinism-{sensing}-{pictures:?}"));
        let other = run_as(
            &settings(sensing, 1, seconds),
            |experiment| Session::rendering(experiment, pictures)?.sensing_side_by_side(),
            &folder,
        );
        assert_eq!(other.to_string(), alone, "{pictures:?}");
    }
    let runs = [(1, "a"), (2, "b"), (1, "c")]
        .map(|(seed, name)| thread::spawn(move || digest(sensing, seed, seconds, name)));
    let [a, b, c] = runs.map(|run| run.join().expect("a run"));
    assert_eq!(a, alone);
    assert_eq!(c, alone);
    assert_ne!(b, alone);
    assert_eq!(digest(sensing, 2, seconds, "alone"), b);
}

#[test]
fn directly_sensed_runs_are_reproducible() {
    check("direct", 60.0);
}

#[test]
fn runs_sensed_through_images_are_reproducible() {
    // Long enough to touch and turn the cap: SEARCH ends after about 0.8 s.
    check("image", 1.5);
}
