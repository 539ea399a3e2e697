//! The measures and claims of a made-up run whose answers are known.

use crate::support;
use feeler::record::Recording;
use feeler::report::{RunData, Summary};
use std::path::PathBuf;

fn recording(name: &str, strokes: u32) -> Recording {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    support::write_run(&path, strokes).expect("a recording");
    Recording::read(&path).expect("the recording")
}

fn close(actual: Option<f64>, expected: f64, tolerance: f64) {
    let actual = actual.expect("a value");
    assert!(
        (actual - expected).abs() < tolerance,
        "{actual} != {expected}"
    );
}

#[test]
fn a_made_up_run_measures_what_it_was_made_of() {
    let recording = recording("measured.mcap", 4);
    let data = RunData::new(&recording);
    let summary = Summary::new(&recording, &data);
    assert_eq!(summary.strokes.len(), 4);
    let [first, .., fourth] = &summary.strokes[..] else {
        panic!("strokes")
    };
    // Tolerances: noise of 0.4 mN·m; one control step of a hundred; the made-up ramps.
    close(first.peak_torque, 0.029, 0.0005);
    close(first.mean_grasp_force, 1.2, 0.01);
    close(first.cap_turn, 0.4, 0.001);
    close(fourth.cap_turn, 0.0, 1e-12);
    close(first.path_inward_bend, 0.0002, 0.00001);
    close(fourth.path_inward_bend, 0.00095, 0.00002);
    close(fourth.peak_element_force, 0.7 * 2.3, 0.01);
    assert!(fourth.slip_fraction > first.slip_fraction);
    close(summary.real_time_factor, 12.19 / 0.25, 1e-9);
    for claim in &summary.claims {
        assert!(claim.holds, "{claim:#?}");
        assert!(claim.value.is_some(), "{claim:#?}");
    }
}

#[test]
fn what_an_unfinished_run_does_not_define_does_not_hold() {
    let recording = recording("unfinished.mcap", 2);
    let summary = Summary::new(&recording, &RunData::new(&recording));
    let holds = |id| {
        let claim = summary
            .claims
            .iter()
            .find(|c| c.id == id)
            .expect("the claim");
        (claim.holds, claim.value.is_some())
    };
    assert_eq!(holds("four-heaps"), (false, true));
    assert_eq!(holds("first-stroke-torque-rises"), (true, true));
    for id in ["closed-after-third", "bumps-in-step", "path-saturates"] {
        assert_eq!(holds(id), (false, false), "{id}");
    }
    let text = &summary.claims[2].text;
    assert!(text.contains("not defined in this recording"), "{text}");
    assert!(!summary.to_json().unwrap().contains("NaN"));
}

#[test]
fn a_run_without_messages_defines_nothing_and_breaks_nothing() {
    let recording = recording("empty.mcap", 0);
    let summary = Summary::new(&recording, &RunData::new(&recording));
    assert!(recording.complete);
    assert!(summary.strokes.is_empty());
    assert!(summary.claims.iter().all(|claim| !claim.holds));
    assert_eq!(summary.cap_angle, None);
}

#[test]
fn the_keys_of_the_summary_are_stable() {
    let recording = recording("keys.mcap", 4);
    let summary = Summary::new(&recording, &RunData::new(&recording));
    let json: serde_json::Value = serde_json::from_str(&summary.to_json().unwrap()).unwrap();
    let keys = |value: &serde_json::Value| {
        let mut keys: Vec<_> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys.join(" ")
    };
    assert_eq!(
        keys(&json),
        "cap_angle claims complete digest experiment findings outcome real_time_factor seed sensing \
         sim_time strokes task version wall_time"
    );
    assert_eq!(
        keys(&json["strokes"][0]),
        "cap_turn index mean_grasp_force path_inward_bend path_rms_to_contour \
         peak_element_force peak_grasp_force peak_shear_rate peak_torque slip_fraction"
    );
    assert_eq!(keys(&json["claims"][0]), "bound holds id parts text value");
    assert_eq!(
        keys(&json["claims"][0]["parts"][0]),
        "bound holds name relation unit value"
    );
    assert_eq!(json["seed"], u64::MAX);
    let ids: Vec<_> = (json["claims"].as_array().unwrap().iter())
        .map(|claim| claim["id"].as_str().unwrap())
        .collect();
    assert_eq!(
        ids,
        [
            "four-heaps",
            "first-stroke-torque-rises",
            "closed-after-third",
            "shear-rate-marks-closing",
            "bumps-in-step",
            "path-follows-contour",
            "path-saturates",
            "no-damage",
        ]
    );
}
