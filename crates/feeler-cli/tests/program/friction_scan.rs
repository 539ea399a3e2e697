//! The friction scan: its results, its outcome without a measurement, and that a replay gives the same results.

use crate::program::{Ended, document, folder, run, summary};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_record::{MemoryRecorder, Recording, RunLog};
use feeler_report::RunData;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Runs the scan with `settings`, and returns the ended program and its `summary.json`.
fn scan(folder: &Path, settings: &[&str]) -> (Ended, Value) {
    let mut arguments = vec!["run", "friction-scan", "--out", "scan"];
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    let ended = run(folder, &arguments);
    (ended, summary(&folder.join("scan")))
}

const FRICTION: [&str; 4] = [
    "sim.variation.friction=0",
    "sim.variation.kinetic_friction=0",
    "sim.object.specimen.friction.static_friction=0.45",
    "sim.object.specimen.friction.kinetic_friction=0.36",
];

#[test]
fn scan_measures_both_coefficients_and_a_replay_reproduces_them() {
    let folder = folder("friction-scan");
    let (ended, summary) = scan(&folder, &FRICTION);
    ended.done();
    assert_eq!(summary["sensing"], "image");
    assert_eq!(summary["outcome"], "measured");
    let found = |name: &str| summary["findings"][name].as_f64().expect("a number");
    // The required accuracy is 5 %.
    assert!(
        (found("static_friction") / 0.45 - 1.0).abs() < 0.05,
        "{summary}"
    );
    assert!(
        (found("kinetic_friction") / 0.36 - 1.0).abs() < 0.05,
        "{summary}"
    );
    // The specimen is rotated by -2 degrees about W's z. A shear error of 1 % of the load causes an error of half a
    // degree.
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
    // Other strokes give other findings.
    let printed = replay(&["--set=task.friction_scan.strokes=3"]).done();
    assert!(
        printed.contains("first difference of findings: "),
        "{printed}"
    );
    assert!(
        printed.contains("outcome: recorded \"\", replayed \"measured\""),
        "{printed}"
    );
}

#[test]
fn random_specimens_are_measured_within_5_percent() {
    let folder = folder("friction-scan-sweep");
    // Friction differs from seed to seed: static from 0.2 to 1.2, kinetic from 0.6 to 1 of that.
    let arguments = [
        "sweep",
        "friction-scan",
        "--sensing=direct",
        "--trials=24",
        "--seed=9",
        "--vary=load=uniform(0.3,2)",
        "--vary=specimen.orientation_deg.1=uniform(-93.5,-86.5)",
        "--vary=specimen.orientation_deg.2=uniform(-3.5,3.5)",
        "-o=sweep",
    ];
    let printed = run(&folder, &arguments).done();
    assert!(printed.contains("24 of 24 trials succeeded"), "{printed}");
    let mut table = csv::Reader::from_path(folder.join("sweep/trials.csv")).expect("a table");
    let header = table.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|h| h == name).expect("a column");
    let rows: Vec<_> = table.records().map(|row| row.expect("a row")).collect();
    let numbers = |name: &str| {
        let column = column(name);
        let numbers = rows.iter().map(move |row| row[column].parse::<f64>());
        numbers.collect::<Result<Vec<_>, _>>().expect("numbers")
    };
    for coefficient in ["static", "kinetic"] {
        let errors = numbers(&format!("claim.{coefficient}-friction.value"));
        assert!(errors.iter().all(|error| error.abs() <= 0.05), "{errors:?}");
    }
    // The specimens do differ.
    let found = numbers("found.static_friction");
    let (least, most) = found
        .iter()
        .fold((f64::MAX, 0.0_f64), |(a, b), &f| (a.min(f), b.max(f)));
    assert!(least < 0.4 && most > 1.0, "{found:?}");
    assert!(rows.iter().all(|row| &row[column("found")] == "measured"));
    let page = document(&folder.join("sweep/summary.html"));
    assert!(page.contains("found.kinetic_friction"));
}

#[test]
fn report_shows_measured_and_true_coefficients() {
    let folder = folder("friction-scan-report");
    let (ended, _) = scan(&folder, &[&["sensing=\"direct\""][..], &FRICTION].concat());
    assert!(ended.done().contains("3 of 3 claims of this task pass"));
    let page = document(&folder.join("scan/report.html"));
    assert!(page.contains("All 3 claims of this task pass."));
    for words in [
        "Static coefficient</td><td class=\"number\">0.4",
        ">0.45<",
        ">0.36<",
        "measured",
    ] {
        assert!(page.contains(words), "{words}");
    }
    for figure in ["fig-01", "fig-02", "fig-03", "fig-04"] {
        let svg = fs::read_to_string(folder.join(format!("scan/figures/{figure}.svg")))
            .expect("a figure");
        assert!(page.contains(&svg) && svg.len() < 300_000, "{figure}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{figure}");
        roxmltree::Document::parse(&svg).expect("XML");
    }
}

#[test]
fn scan_that_reaches_its_time_limit_has_a_report() {
    for time in ["0.5", "3.0", "9.0"] {
        let folder = folder(&format!("friction-scan-until-{time}"));
        let limit = format!("time_limit={time}");
        let (ended, summary) = scan(&folder, &["sensing=\"direct\"", &limit]);
        assert_eq!(ended.status, Some(1), "{ended:?}");
        assert_eq!(summary["findings"]["static_friction"], Value::Null);
        let page = document(&folder.join("scan/report.html"));
        assert!(page.contains("not measured: static-friction, kinetic-friction"));
        assert!(!page.contains("NaN"));
    }
}

/// The report computes the elements' frames from the recorded tips, the control law from the layout.
#[test]
fn report_and_task_use_the_same_forces() {
    let settings = ["sensing=\"direct\"".to_string()];
    let experiment = Experiment::load("friction-scan", &settings).expect("an experiment");
    let mut session = Session::new(&experiment).expect("a session");
    let facts = session.facts(&experiment.config);
    let recorder = MemoryRecorder::new(&facts).expect("facts");
    let mut log = RunLog::new(recorder, &facts).expect("a log");
    let mut seen = Vec::new();
    for _ in 0..300 {
        let at = session.step().expect("a step");
        at.record(session.control_loop(), &mut log)
            .expect("a record");
        let control_loop = session.control_loop();
        let finger = control_loop.hand_sense().finger(0).expect("a finger");
        seen.push(
            (0..41)
                .map(|element| finger.force(element))
                .collect::<Vec<_>>(),
        );
    }
    let recording = log.into_recorder().into_recording();
    let data = RunData::new(&recording);
    let loaded = seen
        .last()
        .expect("a step")
        .iter()
        .map(|force| force.length());
    assert!(loaded.fold(0.0, f64::max) > 0.3);
    for (row, seen) in seen.iter().enumerate() {
        for (element, &seen) in seen.iter().enumerate() {
            let force = data.fingers[0]
                .force_in_world(row, element)
                .expect("a force");
            // Rounding errors of positions of 0.1 m, relative to a dome of 0.018 m.
            assert!(
                (force - seen).length() < 1e-12,
                "row {row}, element {element}"
            );
        }
    }
}

#[test]
fn scan_without_slip_ends_before_overloading_the_elements() {
    let folder = folder("friction-scan-stuck");
    let settings = [
        "sensing=\"direct\"",
        "sim.object.specimen.friction.static_friction=50.0",
    ];
    let (ended, summary) = scan(&folder, &settings);
    assert_eq!(ended.status, Some(1), "{ended:?}");
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
    // Three times the element's share of the load of 1 N, plus some tilt and noise.
    assert!((1.5..3.3).contains(&shear), "{shear} N");
}

#[test]
fn too_short_stroke_ends_without_slip() {
    let folder = folder("friction-scan-short");
    let settings = [
        "sensing=\"direct\"",
        "task.friction_scan.slide_limit=0.0002",
    ];
    let (ended, summary) = scan(&folder, &settings);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert_eq!(summary["outcome"], "no slip");
    assert!(
        summary["sim_time"].as_f64().expect("a time") < 5.0,
        "{summary}"
    );
}

#[test]
fn impossible_scans_are_refused() {
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
