//! Several programs close the cap as one does.

use super::program::{folder, run};
use super::rig::{Rig, ages_of_moves};
use std::fs;

/// The digest of the run in `folder`.
fn digest(folder: &std::path::Path) -> String {
    let summary = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    summary["digest"].as_str().expect("a digest").to_string()
}

#[test]
fn a_world_that_waits_gives_the_run_of_one_process_bit_for_bit() {
    for (name, sensing) in [
        ("link-step", "--sensing=direct"),
        ("link-image", "--sensing=image"),
    ] {
        let settings = [sensing, "--set=time_limit=4"];
        let rig = Rig::start(folder(name), "max", &settings);
        let (status, said) = rig.hand(&[]).wait();
        // It ends at the time limit, before the cap is closed.
        assert_eq!(status, Some(1), "{said}");
        let one = ["run", "cap-closing", "--out=one", settings[0], settings[1]];
        run(&rig.folder, &one);
        let (several, one) = (rig.folder.join("run"), rig.folder.join("one"));
        assert_eq!(digest(&several), digest(&one), "{sensing}: {said}");
    }
}

#[test]
fn the_cap_is_closed_in_real_time_and_the_record_replays() {
    let rig = Rig::start(folder("link-real-time"), "1", &["--sensing=direct"]);
    let (status, said) = rig.hand(&[]).wait();
    let recording = rig.recording();
    // A busy machine may stop the hand for want of fresh data; it never moves it without.
    let limit = 0.035 + 1e-9;
    let ages = ages_of_moves(&recording);
    assert!(ages.len() > 100, "{said}");
    assert!(ages.iter().all(|age| *age <= limit), "{said}");
    if status == Some(0) {
        let cap = recording.cap.last().expect("the cap").angle;
        assert!(cap > 0.4, "{cap} rad, {said}");
    } else {
        assert!(said.contains("stopped"), "{said}");
    }
    let replayed = run(&rig.folder, &["replay", "run", "--from=forces"]).done();
    assert!(replayed.contains("bit for bit"), "{replayed}");
}
