//! Invalid input is refused with a message that names it and the expected values, and no files are left behind.

use crate::program::{Ended, experiment, feeler, folder, run, whole_run};
use std::fs;
use std::path::Path;

/// Asserts that the reference experiment with `from` replaced by `to` is refused with all of `words`, before any file
/// is created.
fn refused(name: &str, from: &str, to: &str, words: &[&str]) {
    let folder = folder(name);
    experiment(&folder, from, to);
    run(&folder, &["check", "my.toml"]).refused(words);
    run(&folder, &["run", "my.toml", "--out", "out"]).refused(words);
    assert!(!folder.join("out").exists());
    // Errors that do not depend on images are found without them, too.
    if !name.starts_with("picture") {
        run(&folder, &["run", "my.toml", "--sensing=direct"]).refused(words);
        assert!(!folder.join("runs").exists());
    }
}

#[test]
fn values_out_of_range_are_refused() {
    let cases: [(&str, &str, &str, &[&str]); 17] = [
        (
            "stiffness",
            "normal_stiffness = 205.0",
            "normal_stiffness = -3.5",
            &["sim.feeler.normal_stiffness = -3.5", "more than 0"],
        ),
        (
            "relaxation",
            "tip_radius = 0.0021",
            "relaxation = { share = 1.0, time = 0.0 }\ntip_radius = 0.0021",
            &[
                "sim.feeler.relaxation.share = 1: expected 0 to 0.99",
                "sim.feeler.relaxation.time = 0: expected more than 0",
            ],
        ),
        (
            "holder",
            "[sim.servo]",
            "[sim.holder]\nturn_play = -0.01\nlateral = { stiffness = [4e4, 0.0], play = [0.0, 2.0] }\n[sim.servo]",
            &[
                "sim.holder.turn_play = -0.01: expected 0 to 1",
                "sim.holder.lateral.stiffness[1] = 0: expected more than 0",
                "sim.holder.lateral.play[1] = 2: expected 0 to 0.1",
            ],
        ),
        (
            "backlash",
            "lag = 0.0125",
            "lag = 0.0125\nbacklash = nan",
            &["sim.servo.backlash = NaN: expected 0 to 1"],
        ),
        (
            "nan",
            "grasp_force = 1.0",
            "grasp_force = nan",
            &["task.screw.grasp_force = NaN", "more than 0"],
        ),
        (
            "f1-f2",
            "touch_force = 0.1",
            "touch_force = 2.5",
            &["control.over_force = 0.505", "(F1) = 2.5"],
        ),
        (
            "overload",
            "joint_acceleration = 20.0",
            "element_force = 0.3\njoint_acceleration = 20.0",
            &[
                "control.limits.element_force = 0.3",
                "more than control.over_force",
            ],
        ),
        (
            "empty-ring",
            "elements = 8",
            "elements = 0",
            &["rings[1].elements = 0", "1 to 512"],
        ),
        (
            "many-elements",
            "elements = 8",
            "elements = 500",
            &["elements", "533", "512"],
        ),
        (
            "home",
            "home = [-0.038",
            "home = [-1.5",
            &["task.screw.finger[0].home = [-1.5", "cannot be reached"],
        ),
        (
            "unknown-experiment-key",
            "strokes = 4 ",
            "strocks = 4 ",
            &["my.toml", "line", "strocks", "expected one of", "`strokes`"],
        ),
        (
            "type",
            "lag = 0.0125 ",
            "lag = \"fast\" ",
            &["lag", "\"fast\"", "expected a number"],
        ),
        (
            "missing-key",
            "lead = 0.00318 ",
            "# ",
            &["my.toml: 1 missing: sim.object.cap.motion.thread.lead"],
        ),
        (
            "small-steps",
            "step = 0.001",
            "step = 1e-6",
            &["control.period = 0.01", "1 to 1000 times sim.step"],
        ),
        (
            "odd-steps",
            "step = 0.001",
            "step = 0.003",
            &["control.period = 0.01", "a whole number"],
        ),
        (
            "big-picture",
            "width = 640 ",
            "width = 2000000 ",
            &["width", "1 to 4096", "2000000x480"],
        ),
        (
            "optics",
            "preload = 0.05",
            "preload = -1.0",
            &["sim.optics.preload = -1", "0 to 1000"],
        ),
    ];
    for (name, from, to, words) in cases {
        refused(name, from, to, words);
    }
}

#[test]
fn layout_without_rings_is_refused() {
    let folder = folder("no-rings");
    let set = "--set=sensor.fingertip.layout.rings=[]";
    run(&folder, &["run", "cap-closing", set]).refused(&["rings = 0 rings", "at least one"]);
    assert!(!folder.join("runs").exists());
}

#[test]
fn missing_and_unsuitable_calibrations_are_refused() {
    refused(
        "picture-layout",
        "elements = 12",
        "elements = 13",
        &[
            "another fingertip",
            "elements",
            "= 13 in the configuration, 12 in the calibration",
        ],
    );
    let name = "reference-fingertip.coupled.calibration.toml";
    refused(
        "picture-missing",
        name,
        "nowhere.toml",
        &["sensor.calibration", "nowhere.toml", "feeler calibrate"],
    );
    refused(
        "picture-no-calibration",
        name,
        "my.toml",
        &["sensor.calibration", "my.toml", "not a calibration"],
    );
}

#[test]
fn invalid_settings_are_refused() {
    let folder = folder("settings");
    let cases: [(&str, &[&str]); 10] = [
        (
            "control.nope=1",
            &["--set control.nope=1", "unknown field `nope`", "`period`"],
        ),
        ("nope.deep.er=1", &["unknown field `nope`"]),
        ("control.period", &["expected key=value"]),
        (
            "control.period=soon",
            &["--set control.period=soon", "\"soon\"", "expected a number"],
        ),
        ("control.period.x=1", &["control.period.x", "single value"]),
        (
            "task.screw.finger.2.home=[0, 0, 0]",
            &["task.screw.finger.2", "0 to 1"],
        ),
        (
            "sensor.fingertip.layout.rings.x.elements=1",
            &["rings.x", "0 to 3"],
        ),
        (
            "control.law=telepathy",
            &[
                "--set control.law",
                "\"telepathy\"",
                "expected one of tri-axial",
            ],
        ),
        (
            "task.strokes=3",
            &[
                "--set task.strokes=3",
                "unknown field `strokes`",
                "expected one of `screw`",
            ],
        ),
        ("", &["expected key=value"]),
    ];
    for (setting, words) in cases {
        let ended = run(&folder, &["run", "cap-closing", "--set", setting]);
        ended.refused(words);
    }
    let start = ["run", "cap-closing"];
    let seed = [&start[..], &["--seed", "18446744073709551615"]].concat();
    run(&folder, &seed).refused(&["--seed", "18446744073709551615", "0 to 922337203685"]);
    let sensing = [&start[..], &["--sensing", "smell"]].concat();
    run(&folder, &sensing).refused(&["--sensing", "smell", "image, direct"]);
    assert!(!folder.join("runs").exists());
}

#[test]
fn files_that_are_not_experiments_are_refused() {
    let folder = folder("experiments");
    run(&folder, &["run", "nope"]).refused(&["\"nope\"", "expected a file", "cap-closing"]);
    run(&folder, &["run", "."]).refused(&[".: ", "directory", "expected the text"]);
    fs::write(folder.join("latin.toml"), b"name = \"caf\xe9\"").unwrap();
    run(&folder, &["check", "latin.toml"]).refused(&["latin.toml", "UTF-8"]);
    fs::write(folder.join("empty.toml"), b"").unwrap();
    run(&folder, &["check", "empty.toml"]).refused(&[
        "empty.toml: 3 missing: name, sensor.calibration, task",
        "feeler init",
    ]);
    let typo = "[sensor]\ncalibratoin = \"my.calibration.toml\"\n";
    fs::write(folder.join("typo.toml"), typo).unwrap();
    run(&folder, &["check", "typo.toml"]).refused(&["line 2", "calibratoin", "`calibration`"]);
    let cap_closing = include_str!("../../../feeler-lab/experiments/cap-closing.toml");
    let (before, after) = cap_closing.split_once("[task.screw]").unwrap();
    let (_, after) = after.split_once("[sim]").unwrap();
    fs::write(
        folder.join("idle.toml"),
        format!("{before}[task]\n[sim]{after}"),
    )
    .unwrap();
    run(&folder, &["check", "idle.toml"]).refused(&[
        "idle.toml",
        "expected a task",
        "[task.screw]",
    ]);
    fs::write(folder.join("half.toml"), b"name = [").unwrap();
    run(&folder, &["check", "half.toml"]).refused(&["half.toml", "line 1"]);
    if cfg!(target_os = "linux") {
        run(&folder, &["check", "/dev/zero"]).refused(&["/dev/zero", "longer than 16 MiB"]);
    }
}

#[test]
fn unwritable_outputs_are_refused() {
    let folder = folder("unwritable");
    fs::write(folder.join("file"), "").unwrap();
    let start = ["run", "cap-closing", "--sensing=direct", "--out"];
    for out in ["file", "file/below"] {
        let arguments = [&start[..], &[out]].concat();
        run(&folder, &arguments).refused(&[&format!("--out {out}"), "expected a new folder"]);
    }
    let calibrate = ["calibrate", "--simulated", "-o", "file/below"];
    run(&folder, &calibrate).refused(&["--output file/below", "expected a file"]);
    fs::write(folder.join("runs"), "").unwrap();
    run(&folder, &start[..3]).refused(&["runs/cap-closing-direct-seed0", "--out"]);
    assert_eq!(fs::read(folder.join("file")).unwrap(), b"");
    // If a report cannot be written, the outdated one is removed, too.
    let run_folder = whole_run(&folder);
    fs::remove_dir_all(run_folder.join("figures")).unwrap();
    fs::write(run_folder.join("figures"), "").unwrap();
    run(&folder, &["report", "run"]).refused(&["run/figures"]);
    assert!(!run_folder.join("report.html").exists());
    assert!(!run_folder.join("summary.json").exists());
}

#[test]
fn existing_run_is_not_overwritten() {
    let folder = folder("taken");
    let run_folder = whole_run(&folder);
    let before = fs::read(run_folder.join("recording.mcap")).unwrap();
    let again = ["run", "cap-closing", "--sensing=direct", "--out=run"];
    run(&folder, &again).refused(&[
        "--out run",
        "already contains a run",
        "expected a new folder",
    ]);
    assert_eq!(fs::read(run_folder.join("recording.mcap")).unwrap(), before);
    fs::remove_file(run_folder.join("recording.mcap")).unwrap();
    run(&folder, &again).refused(&["--out run", "report.html"]);
}

#[test]
fn messages_name_types_in_plain_words() {
    let folder = folder("plain-words");
    let cases = [
        ("time_limit=long", "the text \"long\": expected a number"),
        ("seed=-1", "expected a whole number, 0 or more"),
        ("task.screw.strokes=1.5", "expected a whole number"),
        ("name=3", "expected text"),
        ("time_limit=1e300", "time_limit = 1e300: expected"),
    ];
    for (setting, words) in cases {
        let said = run(&folder, &["check", "cap-closing", "--set", setting]).refused(&[words]);
        for rust in ["f64", "u64", "u32", "usize", "000000000000"] {
            assert!(!said.contains(rust), "{said}");
        }
    }
    run(&folder, &["run", "cap-closing", "--seed", "-1"]).refused(&[
        "'-1'",
        "--seed",
        "a whole number from 0",
    ]);
}

#[test]
fn truncated_recording_is_reported_up_to_its_end() {
    let folder = folder("truncated");
    let run_folder = whole_run(&folder);
    let recording = run_folder.join("recording.mcap");
    let bytes = fs::read(&recording).unwrap();
    fs::write(&recording, &bytes[..bytes.len() / 2]).unwrap();
    let ended = run(&folder, &["report", "run"]);
    assert!(ended.stdout.contains("run/report.html"), "{ended:?}");
    ended.refused(&["incomplete", "up to", "the report covers the run"]);
    let page = fs::read_to_string(run_folder.join("report.html")).unwrap();
    assert!(page.contains("INCOMPLETE: readable up to"));
}

#[test]
fn unreadable_recordings_invalidate_the_report() {
    let folder = folder("unreadable");
    let run_folder = whole_run(&folder);
    let recording = run_folder.join("recording.mcap");
    let good = fs::read(&recording).unwrap();
    for bytes in [&b"not a recording"[..], b"", &good[..40]] {
        fs::write(&recording, &good).unwrap();
        run(&folder, &["report", "run"]).done();
        fs::write(&recording, bytes).unwrap();
        let words = [
            "run/recording.mcap",
            "nothing readable",
            "report.html.stale",
        ];
        run(&folder, &["report", "run"]).refused(&words);
        nothing_looks_valid(&run_folder);
        // The second time, there is no report to set aside.
        run(&folder, &["report", "run"]).refused(&words[..2]);
        nothing_looks_valid(&run_folder);
    }
    fs::remove_file(&recording).unwrap();
    for path in ["run", "nowhere"] {
        run(&folder, &["report", path]).refused(&[path, "no recording", "expected the folder"]);
    }
    let figure = "run/figures/fig-08.svg";
    run(&folder, &["report", figure]).refused(&[figure, "nothing readable"]);
    assert!(!run_folder.join("figures/fig-08").exists());
}

fn nothing_looks_valid(run_folder: &Path) {
    assert!(!run_folder.join("report.html").exists());
    assert!(!run_folder.join("summary.json").exists());
}

#[test]
fn closed_standard_error_causes_no_panic() {
    let folder = folder("no-stderr");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = feeler(&folder, &["run", "nope"]).stderr(writer).output();
    assert_eq!(Ended::of(output.unwrap()).status, Some(2));
}

/// The rubber is so stiff that a feeler moves further than its depth in one step of 1 ms, and forces grow to NaN.
#[test]
fn diverging_simulation_ends_without_a_panic() {
    let folder = folder("diverges");
    let arguments = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--set=sim.feeler.normal_stiffness=1e4",
        "--out=x",
    ];
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(folder.join("x/report.html").exists());
}
