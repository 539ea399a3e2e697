//! `feeler cameras`, and the camera simulated by Aravis as a source. Without Aravis, the message about it is checked.

use crate::program::{folder, rows, run};
use crate::skip;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Returns `true` if Aravis is installed. Otherwise checks the message about it, and reports the test as skipped.
fn has_aravis(folder: &Path) -> bool {
    let listed = run(folder, &["cameras", "--json"]).done();
    let listed: Value = serde_json::from_str(&listed).expect("JSON");
    let missing = listed["genicam"]["missing"].as_array().expect("a list");
    match missing.first().and_then(Value::as_str) {
        None => true,
        Some(reason) => {
            assert!(reason.contains("libaravis-0.8-0") || reason.contains("--features genicam"));
            skip::skipped(reason);
            false
        }
    }
}

#[test]
fn cameras_are_listed_as_text_and_as_json() {
    let folder = folder("cameras");
    if !has_aravis(&folder) {
        return;
    }
    let words = run(&folder, &["cameras", "--simulated"]).done();
    for expected in [
        "genicam:Fake_1",
        "Aravis Fake, serial number 1 (Fake",
        "sensor 2048x2048 px, now 512x512 px from 0,0",
        "exposure 0.00001 to 10 s, gain 0 to 10, rate 0.1 to 1000 Hz",
        "trigger free, Line0, software",
    ] {
        assert!(words.contains(expected), "no {expected:?} in {words}");
    }
    let listed = run(&folder, &["cameras", "--simulated", "--json"]).done();
    let listed: Value = serde_json::from_str(&listed).expect("JSON");
    let cameras = listed["genicam"]["cameras"].as_array().expect("a list");
    let fake = cameras
        .iter()
        .find(|camera| camera["source"] == "genicam:Fake_1");
    assert_eq!(
        fake.expect("the simulated camera")["sensor_size"],
        serde_json::json!([2048, 2048])
    );
    assert!(listed["video4linux"]["missing"].is_array());
}

#[test]
fn a_genicam_camera_is_measured() {
    let folder = folder("cameras-measure");
    run(&folder, &["cameras", "--measure", "picture.png"])
        .refused(&["--measure picture.png: expected a camera"]);
    run(&folder, &["cameras", "--gain=1"]).refused(&["--gain requires --measure"]);
    run(&folder, &["cameras", "--rate=10"]).refused(&["--measure"]);
    if !has_aravis(&folder) {
        return;
    }
    run(&folder, &["cameras", "--measure", "genicam:none"]).refused(&["no such camera"]);
    let measure = ["cameras", "--measure", "genicam:Fake_1", "--rate=20"];
    let size = ["--size=320x240", "--exposure=0.001"];
    let words = run(&folder, &[&measure[..], &size].concat()).done();
    for expected in [
        "genicam:Fake_1: 320x240 px",
        "(20 Hz requested)",
        " dropped, 0 damaged",
        " MB/s",
        "jitter",
    ] {
        assert!(words.contains(expected), "no {expected:?} in {words}");
    }
    let json = run(&folder, &[&measure[..], &size, &["--json"]].concat()).done();
    let measured: Value = serde_json::from_str(&json).expect("JSON");
    let number = |key: &str| {
        measured[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key}: {json}"))
    };
    assert_eq!(measured["camera"], "genicam:Fake_1");
    assert_eq!((number("width_px"), number("height_px")), (320.0, 240.0));
    let (frames, seconds, rate) = (number("frames"), number("seconds"), number("rate"));
    assert!(
        (rate - (frames - 1.0) / seconds).abs() < 1e-6 && frames > 1.0,
        "{json}"
    );
    // One byte per pixel.
    let bytes = number("bytes_per_second");
    assert!(
        (bytes - rate * 320.0 * 240.0).abs() < 1e-3 * bytes,
        "{json}"
    );
    for spread in ["decoding", "interval"] {
        let [min, mean, max] = ["min", "mean", "max"].map(|key| measured[spread][key].as_f64());
        assert!(min.is_some() && min <= mean && mean <= max, "{json}");
    }
}

#[cfg(unix)]
#[test]
fn interrupted_measurement_reports_its_results() {
    use std::process::{Command, Stdio};
    let folder = folder("cameras-measure-interrupted");
    if !has_aravis(&folder) {
        return;
    }
    let measure = ["cameras", "--measure", "genicam:Fake_1", "--json"];
    let mut child = crate::program::feeler(&folder, &measure);
    let child = child.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = child.spawn().expect("the program");
    std::thread::sleep(std::time::Duration::from_secs(2));
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let ended = crate::program::Ended::of(child.wait_with_output().unwrap());
    // On a busy computer the measurement may not have started.
    if ended.status == Some(1) {
        let measured: Value = serde_json::from_str(&ended.stdout).expect("JSON");
        assert!(
            measured["seconds"]
                .as_f64()
                .is_some_and(|seconds| seconds < 4.0),
            "{ended:?}"
        );
    }
}

/// Two elements on the gradient that the simulated camera produces.
const LAYOUT: &str = "version = 1\nwidth = 512\nheight = 512\ndark_level = 10\n\
    [[element]]\ncentre_px = [160.0, 200.0]\nradius_px = 20.0\n[[element]]\ncentre_px = [320.0, 200.0]\nradius_px = 20.0\n";

#[test]
fn sense_reads_a_genicam_camera() {
    let folder = folder("sense-genicam");
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    if !has_aravis(&folder) {
        return;
    }
    let refused = |arguments: &[&str], words: &[&str]| {
        let common = ["sense", "--layout=layout.toml"];
        run(&folder, &[&common[..], arguments].concat()).refused(words);
    };
    refused(
        &["genicam:none"],
        &["genicam:none", "no such camera", "feeler cameras"],
    );
    refused(
        &["genicam:Fake_1", "--gain=11"],
        &["a gain of 11", "0 to 10"],
    );
    refused(
        &["genicam:Fake_1", "--size=64x64"],
        &["--size 64x64", "512x512"],
    );
    refused(
        &["genicam:Fake_1", "--trigger=Line5"],
        &["trigger Line5", "Line0, Software"],
    );
    // The stream is endless; `head` closes the pipe after some rows.
    let script = "\"$FEELER\" sense genicam:Fake_1 --layout layout.toml --rate 60 --exposure 0.01 --roi-offset 16,32 \
                  | head -n 41 > sensed.csv";
    let shell = std::process::Command::new("sh")
        .args(["-c", script])
        .env("FEELER", env!("CARGO_BIN_EXE_feeler"))
        .current_dir(&folder)
        .status();
    assert!(shell.expect("a shell").success());
    let sensed = rows(&folder.join("sensed.csv"));
    assert_eq!(sensed.len(), 40);
    let stamp = |row: usize| sensed[row]["stamp"].parse::<f64>().expect("a time");
    // Both elements of a frame have its stamp, and stamps increase from frame to frame.
    assert!((0..20).all(|frame| stamp(2 * frame) == stamp(2 * frame + 1)));
    assert!((1..20).all(|frame| stamp(2 * frame) > stamp(2 * frame - 2)));
}
