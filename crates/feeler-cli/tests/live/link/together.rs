//! A distributed hand closes the cap like a single process.

use super::faults::{GOES_ON, NO_HURRY, STALE};
use crate::program::{experiment, run};
use crate::rig::{QUARTER, Setup, ages_of_moves};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// The digest of the run in `folder`.
fn digest(folder: &Path) -> String {
    let summary = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    summary["digest"].as_str().expect("a digest").to_string()
}

#[test]
fn lockstep_run_equals_the_run_of_one_process_bit_for_bit() {
    let runs = [
        ("cap-closing", "direct"),
        ("cap-closing", "image"),
        ("lift", "direct"),
    ];
    for (experiment, sensing) in runs {
        let name = format!("link-step-{experiment}-{sensing}");
        equals_one_process(Setup::new(&name).of(experiment), sensing);
    }
}

#[test]
fn lockstep_run_with_four_joints_per_finger_equals_the_run_of_one_process() {
    let setup = Setup::new("link-four-joints").of("my.toml");
    four_joints(&setup.folder);
    equals_one_process(setup, "direct");
}

/// Asserts that the first seconds of a run of several programs in lockstep equal those of one process.
fn equals_one_process(setup: Setup, sensing: &str) {
    let experiment = setup.experiment;
    let mut setup = setup.with(&["time_limit=4"]).at("max");
    setup.settings.push(format!("--set=sensing={sensing}"));
    setup.settings.remove(0);
    let rig = setup.start();
    let (status, said) = rig.setup.hand(&[]).wait();
    // The run ends at the time limit, before the task is done.
    assert_eq!(status, Some(1), "{said}");
    let mut one = vec!["run", experiment, "--out=one"];
    one.extend(rig.setup.settings.iter().map(String::as_str));
    run(&rig.setup.folder, &one);
    let of = |run: &str| digest(&rig.setup.folder.join(run));
    assert_eq!(of("run"), of("one"), "{experiment}, {sensing}: {said}");
}

/// Writes `my.toml`: the reference experiment with fingers of four joints.
fn four_joints(folder: &Path) {
    experiment(folder, "", "");
    let path = folder.join("my.toml");
    let text = fs::read_to_string(&path).expect("an experiment");
    let (head, rest) = text.split_once("[[hand.finger]]").expect("a finger");
    let (_, rest) = rest.split_once("[control]\n").expect("the control");
    let finger = |x: f64, yaw: f64| {
        format!(
            r#"[[hand.finger]]
base_position = [{x}, 0.0, 0.0576]
base_rpy = [0.0, 0.0, {yaw}]
joints = [
  {{ name = "turn", lower = -1.0, upper = 1.0, speed = 2.0 }},
  {{ name = "first", lower = -0.5, upper = 2.1, speed = 2.0 }},
  {{ name = "second", lower = -2.6, upper = 0.0, speed = 2.0 }},
  {{ name = "third", lower = -2.6, upper = 0.0, speed = 2.0 }},
]
dh = [
  {{ joint = "turn", a = 0.03, alpha_deg = 90.0 }},
  {{ joint = "first", a = 0.05 }},
  {{ joint = "second", a = 0.04 }},
  {{ joint = "third", a = 0.045 }},
]

"#
        )
    };
    let hand = [finger(-0.1655, 0.0), finger(0.1655, PI)].concat();
    fs::write(path, format!("{head}{hand}[control]\n{rest}")).expect("an experiment");
}

#[test]
fn hand_closes_the_cap_in_real_time_and_the_recording_replays() {
    // Two strokes close the cap, though not tightly.
    let rig = Setup::new("link-on-the-clock").with(&[NO_HURRY, GOES_ON, "task.screw.strokes=2"]);
    let rig = rig.at(QUARTER).start();
    let (status, said) = rig.setup.hand(&[]).wait();
    assert_eq!(status, Some(0), "{said}");
    let recording = rig.setup.recording();
    let ages = ages_of_moves(&recording);
    assert!(ages.len() > 100, "{said}");
    assert!(ages.iter().all(|age| *age <= STALE), "{said}");
    let cap = recording.cap.last().expect("the cap").angle;
    assert!(cap > 0.4, "{cap} rad, {said}");
    let replayed = run(&rig.setup.folder, &["replay", "run", "--from=forces"]).done();
    assert!(replayed.contains("bit for bit"), "{replayed}");
}
