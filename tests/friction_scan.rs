//! The friction scan through the program: what it finds, what it says where it cannot, and that a replay
//! finds the same.

#[path = "support/program.rs"]
mod program;

use feeler::record::Recording;
use program::{Ended, folder, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Runs the scan with these settings; how it ended and its `summary.json`.
fn scan(folder: &Path, settings: &[&str]) -> (Ended, Value) {
    let mut arguments = vec!["run", "friction-scan", "--out", "scan"];
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    let ended = run(folder, &arguments);
    let summary = fs::read_to_string(folder.join("scan/summary.json")).expect("a summary");
    (ended, serde_json::from_str(&summary).expect("JSON"))
}

const FRICTION: [&str; 4] = [
    "sim.variation.friction=0",
    "sim.variation.kinetic_friction=0",
    "sim.object.specimen.friction.static_friction=0.45",
    "sim.object.specimen.friction.kinetic_friction=0.36",
];

#[test]
fn it_finds_both_coefficients_from_pictures_and_a_replay_finds_the_same() {
    let folder = folder("friction-scan");
    let (ended, summary) = scan(&folder, &FRICTION);
    ended.done();
    assert_eq!(summary["sensing"], "image");
    assert_eq!(summary["outcome"], "measured");
    let found = |name: &str| summary["findings"][name].as_f64().expect("a number");
    // What the issue asks for, 5 %.
    assert!(
        (found("static_friction") / 0.45 - 1.0).abs() < 0.05,
        "{summary}"
    );
    assert!(
        (found("kinetic_friction") / 0.36 - 1.0).abs() < 0.05,
        "{summary}"
    );
    // The specimen is turned by -2 degrees about W's z; half a degree is what shear that is off by 1 % of the load makes.
    assert!((found("tilt").to_degrees() + 2.0).abs() < 0.5, "{summary}");

    let replay = |settings: &[&str]| {
        let start = ["replay", "scan", "--from", "forces"];
        run(&folder, &[&start[..], settings].concat())
    };
    let printed = replay(&[]).done();
    assert!(
        printed.contains("findings") && printed.contains("bit for bit"),
        "{printed}"
    );
    // Other strokes are other findings.
    let printed = replay(&["--set=task.friction_scan.strokes=3"]).done();
    assert!(printed.contains("first of findings: "), "{printed}");
    assert!(
        printed.contains("outcome: \"\" on record, \"measured\" now"),
        "{printed}"
    );
}

#[test]
fn where_nothing_slips_it_says_so_and_spares_the_elements() {
    let folder = folder("friction-scan-stuck");
    let settings = [
        "sensing=\"direct\"",
        "sim.object.specimen.friction.static_friction=50.0",
    ];
    let (ended, summary) = scan(&folder, &settings);
    ended.done();
    assert_eq!(summary["outcome"], "no slip");
    assert_eq!(summary["findings"]["static_friction"], Value::Null);
    let recording = Recording::read(folder.join("scan/recording.mcap")).expect("a recording");
    let forces = recording.fingers[0]
        .tactile
        .iter()
        .flat_map(|frame| &frame.forces);
    let shear = forces
        .map(|force| force.x.hypot(force.y))
        .fold(0.0, f64::max);
    // Three times what the element bears of the load of 1 N, and a little for tilt and noise.
    assert!((1.5..3.3).contains(&shear), "{shear} N");
}

#[test]
fn too_short_a_stroke_ends_without_a_slip() {
    let folder = folder("friction-scan-short");
    let settings = [
        "sensing=\"direct\"",
        "task.friction_scan.slide_limit=0.0002",
    ];
    let (ended, summary) = scan(&folder, &settings);
    ended.done();
    assert_eq!(summary["outcome"], "no slip");
    assert!(
        summary["sim_time"].as_f64().expect("a time") < 5.0,
        "{summary}"
    );
}

#[test]
fn what_cannot_be_done_is_refused() {
    let folder = folder("friction-scan-refused");
    let cases: [(&str, &[&str]); 11] = [
        (
            "sim.object.specimen.position=[0.04, 0.0, 0.1]",
            &[
                "search_limit = 0.012",
                "nothing to touch",
                "sim.object.specimen, at 0.0",
            ],
        ),
        (
            "task.friction_scan.approach=[0, 0, 1]",
            &["nothing to touch", "sim.object.specimen"],
        ),
        (
            "control.limits.workspace_upper=[-0.036, 0.03, 0.13]",
            &["touches the specimen", "control.limits.workspace_lower"],
        ),
        (
            "task.friction_scan.load=2.5",
            &[
                "task.friction_scan.load = 2.5",
                "less than control.over_force (F2) = 2.5",
            ],
        ),
        (
            "task.friction_scan.load=0.05",
            &["more than control.touch_force (F1) = 0.1"],
        ),
        (
            "task.friction_scan.travel=0",
            &["travel = 0", "more than 0"],
        ),
        (
            "task.friction_scan.slide=[0, 0, 0]",
            &["slide = [0.0, 0.0, 0.0]", "5 degrees or more off"],
        ),
        (
            "task.friction_scan.slide=[-3, 0.01, 0]",
            &["5 degrees or more off", "approach = [1.0, 0.0, 0.0]"],
        ),
        (
            "task.friction_scan.strokes=2",
            &["strokes = 2", "3 to 1000"],
        ),
        (
            "task.friction_scan.settle_time=0.1",
            &["settle_time = 0.1", "0.2 to 1000"],
        ),
        (
            "task.screw.strokes=2",
            &["--set task.screw.strokes=2", "missing field"],
        ),
    ];
    for (setting, words) in cases {
        for command in ["check", "run"] {
            run(&folder, &[command, "friction-scan", "--set", setting]).refused(words);
        }
    }
    assert!(!folder.join("runs").exists());
}
