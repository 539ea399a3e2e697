//! `feeler simulate-grasps`, and thresholds that `feeler score-slip` takes from other recordings.

use crate::program::{document, folder, rows, run};
use crate::score_slip_recorded::{grasps, number, said};
use std::collections::HashMap;
use std::fs;
use std::path::Path;

const GRAVITY: f64 = 9.81;

type Row = HashMap<String, String>;

fn value(row: &Row, column: &str) -> f64 {
    row[column].parse().expect("a number")
}

/// Simulates grasps, and returns their labels.
fn simulate(folder: &Path, name: &str, arguments: &[&str]) -> Vec<Row> {
    let out = format!("--out={name}");
    let ended = run(folder, &[&["simulate-grasps", &out], arguments].concat());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    rows(&folder.join(name).join("labels.csv"))
}

/// Force of the object on the gel in a frame of a recording (N): upward, along z, and into the gel.
fn force(recording: &[Row], frame: &str) -> (f64, f64) {
    let own = || recording.iter().filter(|row| row["frame"] == frame);
    let sum = |column: &str| own().map(|row| value(row, column)).sum();
    (sum("true_f_y"), sum("true_f_z"))
}

#[test]
fn simulated_grasps_have_correct_labels() {
    let folder = folder("simulate-grasps");
    let labels = simulate(&folder, "grasps", &["--count=6", "--seed=1"]);
    let slips = labels.iter().filter(|row| row["slip"] == "1").count();
    assert!(
        slips > 0 && slips < labels.len(),
        "{slips} of {}",
        labels.len()
    );
    let frames = rows(&folder.join("grasps/frame_labels.csv"));
    for label in &labels {
        let name = &label["recording"];
        let recording = rows(&folder.join(format!("grasps/recordings/{name}.csv")));
        let last = &recording.last().unwrap()["frame"];
        // The recording starts untouched, except for noise of at most 0.3 px.
        assert_eq!(force(&recording, "0"), (0.0, 0.0), "{name}");
        let first = recording.iter().filter(|row| row["frame"] == "0");
        first.for_each(|row| assert!(value(row, "u_x").abs() < 1.5, "{row:?}"));
        let own = frames.iter().filter(|row| row["recording"] == *name);
        let slipped: Vec<_> = own.map(|row| row["slip"].as_str()).collect();
        assert!(slipped.is_sorted() && slipped[0] == "0", "{slipped:?}");
        assert_eq!(*slipped.last().unwrap(), label["slip"], "{name}");
        assert!(label["lost"] == "0" || label["slip"] == "1", "{label:?}");
        let (up, pressed) = force(&recording, last);
        if label["lost"] == "1" {
            assert_eq!((up, pressed), (0.0, 0.0), "{name}");
        } else if label["slip"] == "0" {
            // Friction bears the weight, together with the other finger.
            let share = -up / (value(label, "mass_kg") * GRAVITY);
            assert!((0.0..1.0).contains(&share), "{name}: {share}");
            assert!(up.abs() < value(label, "friction") * pressed, "{name}");
        }
    }
}

#[test]
fn simulated_grasps_depend_only_on_the_seed() {
    let folder = folder("simulate-grasps-again");
    let one = simulate(&folder, "one", &["--count=3", "--seed=5", "--jobs=1"]);
    assert_eq!(
        one,
        simulate(&folder, "two", &["--count=3", "--seed=5", "--jobs=3"])
    );
    assert_ne!(one, simulate(&folder, "other", &["--count=3", "--seed=6"]));
    for file in [
        "recordings/00002.csv",
        "recordings/00002.toml",
        "frame_labels.csv",
    ] {
        let read = |name: &str| fs::read(folder.join(name).join(file)).unwrap();
        assert!(read("one") == read("two"), "{file}");
    }
    // Nothing is overwritten.
    run(&folder, &["simulate-grasps", "--count=1", "--out=one"])
        .refused(&["labels.csv", "--force"]);
    run(&folder, &["simulate-grasps", "--count=0"]).refused(&["--count"]);
}

#[test]
fn thresholds_of_simulated_grasps_are_applied_to_recordings() {
    let folder = folder("score-slip-transfer");
    grasps(&folder);
    simulate(&folder, "sim", &["--count=8", "--seed=1"]);
    let sim = ["sim/recordings", "sim/labels.csv"];
    let alone = run(&folder, &["score-slip", sim[0], sim[1], "--out=alone"]);
    assert_eq!(alone.status, Some(0), "{alone:?}");
    let arguments = ["score-slip", "tracks", "labels.csv", "--layout=layout.toml"];
    let others = ["--thresholds-from", sim[0], sim[1]];
    let ended = run(&folder, &[&arguments[..], &others].concat());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let text = ended.stdout;
    assert!(
        text.contains("thresholds from sim/recordings: 8 recordings"),
        "{text}"
    );
    // The transferred threshold equals the one that is chosen on the simulated grasps alone.
    let threshold = said(&text, "contact loss", "transfer threshold");
    assert_eq!(threshold, said(&alone.stdout, "contact loss", "threshold"));
    let scores = rows(&folder.join("slip/scores.csv"));
    let own: Vec<_> = scores
        .iter()
        .filter(|row| row["detector"] == "contact_loss")
        .collect();
    let mut right = 0;
    for row in &own {
        let says = value(row, "score") > value(row, "other_threshold");
        assert_eq!(
            row["says_slip_by_other"],
            u8::from(says).to_string(),
            "{row:?}"
        );
        right += usize::from(row["says_slip_by_other"] == row["slip"]);
    }
    let percent = 100.0 * right as f64 / own.len() as f64;
    assert!((number(&text, "contact loss", "transfer accuracy (%)") - percent).abs() < 0.06);
    // Thresholds in the unit of a sensor are not transferred.
    let rate = scores
        .iter()
        .find(|row| row["detector"] == "shear_rate")
        .unwrap();
    assert_eq!(rate["other_threshold"], "");
    assert!(
        document(&folder.join("slip/slip.html")).contains("With thresholds of other recordings")
    );
}

#[test]
fn missing_threshold_recordings_are_refused() {
    let folder = folder("score-slip-transfer-refused");
    grasps(&folder);
    let with = |others: &[&str]| {
        let arguments = ["score-slip", "tracks", "labels.csv", "--thresholds-from"];
        run(&folder, &[&arguments, others].concat())
    };
    with(&["none", "labels.csv"]).refused(&["none", "recordings"]);
    with(&["tracks", "none.csv"]).refused(&["none.csv"]);
    with(&["tracks"]).refused(&["--thresholds-from"]);
    fs::write(folder.join("frames.csv"), "video,frame,slip\n0-hold,0,1\n").unwrap();
    with(&["tracks", "frames.csv"]).refused(&["--thresholds-from", "expected the same"]);
    run(
        &folder,
        &["score-slip", "--thresholds-from", "tracks", "labels.csv"],
    )
    .refused(&["--thresholds-from", "LABELS"]);
}
