//! Measures and claims of a synthetic run with known results.

use crate::support;
use feeler_record::Recording;
use feeler_report::claims::of_any_hand;
use feeler_report::measures::Peaks;
use feeler_report::{RunData, Summary};
use glam::DVec3;
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
fn measures_of_a_synthetic_run_match_its_parameters() {
    let recording = recording("measured.mcap", 4);
    let data = RunData::new(&recording);
    let summary = Summary::new(&recording, &data);
    assert_eq!(summary.strokes.len(), 4);
    let [first, .., fourth] = &summary.strokes[..] else {
        panic!("strokes")
    };
    // Tolerances: noise of 0.4 mN·m, one of a hundred control steps, and the synthetic ramps.
    close(first.peak_torque, 0.029, 0.0005);
    close(first.mean_grasp_force, 1.2, 0.01);
    close(first.cap_turn, 0.4, 0.001);
    close(fourth.cap_turn, 0.0, 1e-12);
    // MOVE ends one step before the full travel.
    let bend = support::sagitta(0.99 * support::TRAVEL);
    let [first_bend, .., fourth_bend] = support::BENDS;
    close(first.path_inward_bend, first_bend * bend, 1e-9);
    close(fourth.path_inward_bend, fourth_bend * bend, 1e-9);
    // A parabola fits an arc over a third of its radius to a few per cent.
    close(first.path_curvature, first_bend, 0.01);
    close(fourth.path_curvature, fourth_bend, 0.06);
    let kept = |bend: f64| (1.0 - bend) * fourth.line_radius_std.expect("a line");
    // The cap is 0.2 mm off-centre; the line of stroke 4 starts at the end of its arc.
    close(fourth.path_radius_std, kept(fourth_bend), 2e-5);
    close(fourth.slip_precision, 1.0, 1e-12);
    assert_eq!(fourth.true_slip_fraction, fourth.slip_fraction);
    assert!(fourth.over_fraction > Some(0.05), "{fourth:?}");
    assert!(fourth.grasp_force_variation < Some(0.1), "{fourth:?}");
    close(fourth.peak_element_force, 0.7 * 2.3, 0.01);
    assert!(fourth.slip_fraction > first.slip_fraction);
    close(summary.real_time_factor, 12.19 / 0.25, 1e-9);
    // Each peak is at least as high as the previous one; the last two are equal.
    let peaks = Peaks {
        second_below_first: false,
        last_above_first: true,
        last_alike: true,
    };
    let pattern = summary.stroke_pattern.expect("a pattern");
    assert_eq!((pattern.grasp_force, pattern.torque), (peaks, peaks));
    assert!(!pattern.whole());
    for claim in &summary.claims {
        assert!(claim.holds, "{claim:#?}");
        assert!(claim.value.is_some(), "{claim:#?}");
    }
}

#[test]
fn claims_that_an_unfinished_run_does_not_define_do_not_pass() {
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
    assert_eq!(holds("four-peaks"), (false, true));
    assert_eq!(holds("first-stroke-torque-rises"), (true, true));
    for id in ["closed-after-third", "bumps-in-step", "path-saturates"] {
        assert_eq!(holds(id), (false, false), "{id}");
    }
    let text = &summary.claims[2].text;
    assert!(text.contains("not defined in this recording"), "{text}");
    assert!(!summary.to_json().unwrap().contains("NaN"));
}

#[test]
fn a_run_without_messages_has_no_measures_and_causes_no_panic() {
    let recording = recording("empty.mcap", 0);
    let summary = Summary::new(&recording, &RunData::new(&recording));
    assert!(recording.complete);
    assert!(summary.strokes.is_empty());
    assert_eq!(summary.stroke_pattern, None);
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
        "cap_angle claims digest experiment final_torque findings hand_claims outcome peak_element_force real_time_factor \
         reason seed sensing sim_time state stroke_pattern strokes task version wall_time"
    );
    assert_eq!(
        keys(&json["strokes"][0]),
        "cap_turn grasp_force_variation index line_radius_std mean_grasp_force over_fraction path_curvature \
         path_inward_bend path_radius_std peak_element_force peak_grasp_force peak_shear_rate peak_torque \
         slip_fraction slip_precision true_slip_fraction"
    );
    assert_eq!(keys(&json["stroke_pattern"]), "grasp_force torque");
    assert_eq!(
        keys(&json["stroke_pattern"]["torque"]),
        "last_above_first last_alike second_below_first"
    );
    assert_eq!(
        keys(&json["claims"][0]),
        "bound decided_by holds id parts text value verdict"
    );
    assert_eq!(
        keys(&json["claims"][0]["parts"][0]),
        "bound holds name relation unit value"
    );
    assert_eq!(json["seed"], u64::MAX);
    let ids = |claims: &str| -> Vec<_> {
        let claims = json[claims].as_array().unwrap().iter();
        claims
            .map(|c| c["id"].as_str().unwrap().to_string())
            .collect()
    };
    assert_eq!(
        ids("claims"),
        [
            "four-peaks",
            "first-stroke-torque-rises",
            "closed-after-third",
            "shear-rate-marks-closing",
            "bumps-in-step",
            "slip-means-slip",
            "path-follows-contour",
            "path-is-curved",
            "grip-levels-off",
            "path-saturates",
            "no-damage",
        ]
    );
    assert_eq!(
        ids("hand_claims"),
        [
            "hand-follows-cap",
            "hand-path-is-curved",
            "hand-grip-is-steady",
            "hand-overloads-nothing",
            "hand-closes-cap",
        ]
    );
    let with_bottle = json["claims"].as_array().unwrap().iter();
    let with_bottle = with_bottle.filter(|claim| claim["decided_by"] == "hand_and_bottle");
    let with_bottle: Vec<_> = with_bottle
        .map(|claim| claim["id"].as_str().unwrap())
        .collect();
    assert_eq!(
        with_bottle,
        ["four-peaks", "first-stroke-torque-rises", "bumps-in-step"]
    );
}

/// Verdict (`true` if it passes) and value of each claim of any hand.
fn of_hand(data: &RunData) -> [(bool, Option<f64>); 5] {
    let claims = of_any_hand(data, &data.stroke_measures());
    let claims: Vec<_> = claims.iter().map(|c| (c.holds, c.value)).collect();
    claims.try_into().expect("five claims")
}

/// Each corruption of the synthetic run fails exactly one claim.
#[test]
fn each_claim_of_any_hand_detects_its_violation() {
    let recording = recording("any-hand.mcap", 4);
    let data = RunData::new(&recording);
    let rating = data.facts.over_force_threshold;
    let good = of_hand(&data);
    assert_eq!(good.map(|(holds, _)| holds), [true; 5], "{good:?}");
    close(good[3].1, 0.7 * 2.3 / rating, 0.01);
    close(good[4].1, 0.0, 1e-12);
    let broken = |spoil: &dyn Fn(&mut RunData)| {
        let mut data = data.clone();
        spoil(&mut data);
        of_hand(&data).map(|(holds, _)| !holds)
    };
    let fourth = data.whole_stroke(4).expect("stroke 4").clone();
    let pressed = broken(&|data| data.fingers[1].largest_force[0] = 1.26 * rating);
    assert_eq!(pressed, [false, false, false, true, false]);
    let swaying = broken(&|data| {
        let rows = fourth.moving.clone().enumerate();
        rows.for_each(|(i, row)| {
            data.fingers[0].grasp_force[row] *= 1.0 + 0.4 * (0.3 * i as f64).sin();
        });
    });
    assert_eq!(swaying, [false, false, true, false, false]);
    // The cap continues turning or turns back.
    for turn in [0.03, -0.03] {
        let turning = broken(&|data| {
            let last = fourth.rows.end - 1;
            data.cap.as_mut().expect("a cap").angle[last] += turn;
        });
        assert_eq!(turning, [false, false, false, false, true], "{turn}");
    }
    // A straight path along the stroke preserves neither distance nor curvature.
    let straight = broken(&|data| {
        let facts = data.facts.clone();
        for (finger, columns) in data.fingers.iter_mut().enumerate() {
            let direction = DVec3::from(facts.stroke_direction[finger]);
            let start = columns.position[fourth.moving.start];
            for row in fourth.moving.clone() {
                let along = (columns.position[row] - start).dot(direction);
                columns.position[row] = start + along * direction;
            }
        }
    });
    assert_eq!(straight, [true, true, false, false, false]);
}

#[test]
fn claims_without_data_of_a_hand_do_not_pass() {
    let recording = recording("any-hand-unfinished.mcap", 2);
    let unfinished = of_hand(&RunData::new(&recording));
    let known = unfinished.map(|(holds, value)| (holds, value.is_some()));
    let (unknown, whole) = ((false, false), (true, true));
    assert_eq!(known, [unknown, unknown, unknown, whole, unknown]);
    // Claims require at least the paper's number of strokes.
    let mut recording = recording;
    recording.facts.stroke_count = 2;
    let summary = Summary::new(&recording, &RunData::new(&recording));
    assert!(summary.hand_claims.is_empty());
}
