//! Hands whose fingers are chains of joints, described in the experiment or by URDF files.

use crate::program::{folder, run, summary};
use feeler::hand::JointVector;
use feeler_record::Recording;
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;
use std::path::Path;

#[path = "../../../feeler-lab/tests/support/urdf_hands.rs"]
mod urdf_hands;

/// Argument for two fingers like those of an Allegro Hand.
fn allegro() -> String {
    format!("--set={}", urdf_hands::allegro())
}

/// Argument for two fingers like those of a LEAP Hand.
fn leap() -> String {
    format!("--set={}", urdf_hands::leap())
}

fn run_directly(folder: &Path, out: &str, experiment: &str, settings: &[&str]) {
    let arguments = ["run", experiment, "--sensing=direct", "--out", out];
    run(folder, &[&arguments, settings].concat()).done();
}

#[test]
fn four_joint_fingers_close_a_cap() {
    let folder = folder("chains-close");
    for (name, hand) in [("allegro", allegro()), ("leap", leap())] {
        run_directly(&folder, name, "cap-until-closed", &[&hand]);
        let result = summary(&folder.join(name));
        assert_eq!(result["outcome"], "closed", "{name}: {result}");
        assert_eq!(result["success"]["met"], json!(true), "{name}: {result}");
        let recording = Recording::read(folder.join(name).join("recording.mcap")).unwrap();
        for finger in &recording.fingers {
            let turns = finger.joints.iter().map(|joints| joints.position);
            assert!(turns.clone().all(|position| position.len() == 4));
            // Every joint moves, and none leaves its limits by more than the servos' lag allows.
            let low = turns.clone().reduce(JointVector::min).unwrap();
            let range = turns.reduce(JointVector::max).unwrap() - low;
            assert!(
                range.iter().all(|range| range > 0.01 && range < 2.0),
                "{range}"
            );
            assert_eq!(finger.command[100].joint_velocity.len(), 4);
        }
        // The recording contains the hand, and is replayed bit by bit.
        let said = run(&folder, &["replay", name, "--from=forces"]).done();
        assert!(said.contains("bit for bit"), "{said}");
    }
}

#[test]
fn the_law_for_any_hand_works_on_four_joint_fingers() {
    let folder = folder("chains-pivot");
    for (name, hand) in [("allegro", allegro()), ("leap", leap())] {
        let settings = [&hand, "--set=control.law=pivot"];
        run_directly(&folder, name, "cap-closing", &settings);
        let result = summary(&folder.join(name));
        assert_eq!(result["success"]["met"], json!(true), "{name}: {result}");
    }
}

#[test]
fn fingers_of_different_kinematics_work_together() {
    let folder = folder("chains-mixed");
    let leap = leap();
    let (_, fingers) = leap.split_once('[').unwrap();
    let (_, other) = fingers.split_once("}, ").unwrap();
    let three_joints = "{ base_position = [-0.1655, 0.0, 0.0576], phi1_deg = 0.0, phi2_deg = 0.0, links = [0.03, 0.06, 0.055], \
        joint_lower_deg = [-60.0, -30.0, -150.0], joint_upper_deg = [60.0, 120.0, 0.0], joint_speed_limit = [2.0, 2.0, 2.0] }";
    let hand = format!("--set=hand.finger=[{three_joints}, {other}");
    run_directly(&folder, "mixed", "cap-until-closed", &[&hand]);
    let result = summary(&folder.join("mixed"));
    assert_eq!(result["success"]["met"], json!(true), "{result}");
    let recording = Recording::read(folder.join("mixed/recording.mcap")).unwrap();
    let counts = recording
        .fingers
        .iter()
        .map(|finger| finger.joints[0].position.len());
    assert_eq!(counts.collect::<Vec<_>>(), [3, 4]);
}

/// The paper's finger as a Denavit-Hartenberg table moves like its closed form. The kinematics agree within 1e-11 rad/s
/// (unit tests), which the contacts amplify.
#[test]
fn the_papers_finger_as_a_table_closes_the_cap_alike() {
    let folder = folder("chains-paper");
    let finger = |x: f64, pitch: f64, limits: [[f64; 2]; 2]| {
        let [[low_2, high_2], [low_3, high_3]] = limits.map(|limits| limits.map(f64::to_radians));
        let side = 60_f64.to_radians();
        format!(
            "{{ base_position = [{x}, 0.0, 0.0576], base_rpy = [0.0, {pitch}, 0.0], damping_threshold = 0.0055, joints = [\
             {{ name = \"a\", lower = -{side}, upper = {side}, speed = 2.0 }},\
             {{ name = \"b\", lower = {low_2}, upper = {high_2}, speed = 2.0 }},\
             {{ name = \"c\", lower = {low_3}, upper = {high_3}, speed = 2.0 }}], dh = [\
             {{ joint = \"a\", a = 0.03, alpha_deg = 90.0 }}, {{ joint = \"b\", a = 0.06 }}, {{ joint = \"c\", a = 0.055 }}] }}"
        )
    };
    let left = finger(-0.1655, 0.0, [[-30.0, 120.0], [-150.0, 0.0]]);
    let right = finger(0.1655, PI, [[-120.0, 30.0], [0.0, 150.0]]);
    run_directly(&folder, "closed-form", "cap-closing", &[]);
    let table = format!("--set=hand.finger=[{left}, {right}]");
    run_directly(&folder, "table", "cap-closing", &[&table]);
    let read = |name: &str| Recording::read(folder.join(name).join("recording.mcap")).unwrap();
    let (closed_form, table) = (read("closed-form"), read("table"));
    assert_eq!(closed_form.task.len(), table.task.len());
    for (one, other) in closed_form.fingers.iter().zip(&table.fingers) {
        for (one, other) in one.joints.iter().zip(&other.joints) {
            let apart = one.position.distance(other.position);
            assert!(apart < 1e-12, "{apart} rad at {} s", one.stamp);
        }
    }
}

/// Three sliding joints along x, y and z; the one along x is driven by a rack of 20 mm/rad.
fn gantry() -> String {
    let joint = |name: &str, range: f64, speed: f64| {
        format!("{{ name = \"{name}\", lower = -{range}, upper = {range}, speed = {speed} }}")
    };
    let joints = [
        joint("rack", 6.0, 5.0),
        joint("y", 0.12, 0.1),
        joint("z", 0.12, 0.1),
    ]
    .join(", ");
    let rack = "mimic = { joint = \"rack\", multiplier = 0.02 }";
    format!(
        "--set=hand.finger=[{{ base_position = [0.0, 0.0, 0.1], tip_rpy = [0.0, {quarter_turn}, 0.0], joints = [{joints}], frames = [\
         {{ type = \"prismatic\", {rack}, axis = [1.0, 0.0, 0.0] }},\
         {{ type = \"prismatic\", joint = \"y\", axis = [0.0, 1.0, 0.0] }},\
         {{ type = \"prismatic\", joint = \"z\", axis = [0.0, 0.0, 1.0] }}] }}]",
        quarter_turn = FRAC_PI_2,
    )
}

/// A gantry traces an outline, and stops if one of its drives stalls: tolerances in radians do not apply to metres.
#[test]
fn prismatic_joints_trace_an_outline_and_are_monitored() {
    let folder = folder("chains-gantry");
    run_directly(&folder, "traced", "contour", &[&gantry()]);
    let result = summary(&folder.join("traced"));
    assert_eq!(result["success"]["met"], json!(true), "{result}");
    for joint in 0..3 {
        let name = format!("stalled-{joint}");
        let fault = format!(
            "--set=sim.fault=[{{ kind = {{ servo_stall = {{ finger = 0, joint = {joint} }} }}, from = 3.0 }}]"
        );
        let arguments = ["run", "contour", "--sensing=direct", "--out", &name];
        run(&folder, &[&arguments[..], &[&gantry(), &fault]].concat());
        let result = summary(&folder.join(&name));
        let reason = result["reason"].as_str().unwrap_or_default();
        // The joint along z hardly moves on this object.
        assert_eq!(
            reason.contains(&format!("joint {joint} of")),
            joint < 2,
            "{reason}"
        );
    }
}

#[test]
fn invalid_fingers_are_refused_with_an_explanation() {
    let folder = folder("chains-refused");
    let refused = |fingers: &str, words: &[&str]| {
        let setting = format!("--set=hand.finger=[{fingers}]");
        run(&folder, &["run", "cap-closing", &setting]).refused(words);
    };
    fs::write(folder.join("no.urdf"), "<robot><link name=\"a\"/></robot>").unwrap();
    refused(
        "{ urdf = \"missing.urdf\", tip = \"a\" }",
        &["missing.urdf", "URDF"],
    );
    refused(
        "{ urdf = \"no.urdf\" }",
        &["hand.finger[0]", "expected tip"],
    );
    refused(
        "{ urdf = \"no.urdf\", tip = \"a\" }",
        &["no joint leads to link", "no.urdf"],
    );
    refused("{ urdf = 3, tip = \"a\" }", &["urdf: expected text"]);
    let other = "{ base_position = [0.0, 0.0, 0.0], joints = [{ name = \"a\", lower = 0.0, upper = 1.0, speed = 1.0 }], \
        dh = [{ joint = \"a\", a = 0.05 }] }";
    let joints = "joints = [{ name = \"a\", lower = 0.0, upper = 1.0, speed = 1.0 }]";
    let base = "base_position = [0.0, 0.0, 0.0]";
    let no_rows = format!("{{ {base}, {joints} }}, {other}");
    refused(&no_rows, &["hand.finger[0]", "either dh or frames"]);
    refused(
        &format!("{{ {base}, {joints}, phi1_deg = 0.0 }}"),
        &["phi1_deg"],
    );
    refused(&format!("{{ {joints} }}"), &["base_position"]);
    refused(
        &format!("{other}, {other}"),
        &["finger[0].home", "at most 0.05"],
    );
}
