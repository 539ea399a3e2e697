//! A distributed hand closes the cap like a single process.

use super::faults::{GOES_ON, NO_HURRY, STALE};
use crate::program::run;
use crate::rig::{QUARTER, Setup, ages_of_moves};
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
        let setup = Setup::new(&name).of(experiment);
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
