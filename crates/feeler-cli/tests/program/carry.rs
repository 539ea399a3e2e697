//! Carrying objects by touch: slid over a table, lifted, made heavier and slippery.

use crate::program::{folder, part, run, summary};
use serde_json::Value;
use std::path::Path;

/// Runs `experiment` with `settings`, and returns the `summary.json` of the run.
fn carry(folder: &Path, name: &str, experiment: &str, settings: &[String]) -> Value {
    let mut arguments = vec!["run", experiment, "--out", name];
    if !settings
        .iter()
        .any(|setting| setting.starts_with("sensing"))
    {
        arguments.extend(["--sensing", "direct"]);
    }
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    run(folder, &arguments).done();
    summary(&folder.join(name))
}

/// Asserts that the object ended within 2 mm and 3 degrees of the path's end, by ground truth, and never tipped.
fn assert_carried(summary: &Value, what: &str) {
    assert_eq!(summary["outcome"], "carried", "{what}");
    let distance = part(summary, "distance from the end of the path");
    assert!(distance <= 2.0, "{what}: {distance} mm");
    let turned = part(summary, "rotation about the vertical");
    assert!(turned.abs() <= 3.0, "{what}: {turned} degrees");
    let tipped = part(summary, "tilt");
    assert!(tipped <= 3.0, "{what}: {tipped} degrees");
}

#[test]
fn boxes_are_slid_with_various_masses_and_frictions() {
    let folder = folder("carry-slide");
    for experiment in ["slide-box", "slide-box-two"] {
        for (seed, mass) in [0.03, 0.09, 0.15].into_iter().enumerate() {
            for friction in [0.2, 0.4, 0.6] {
                let settings = [
                    format!("sim.object.box.motion.free.mass={mass}"),
                    format!("sim.object.box.motion.free.friction={friction}"),
                    format!("seed={seed}"),
                ];
                let name = format!("{experiment}-{mass}-{friction}");
                let summary = carry(&folder, &name, experiment, &settings);
                assert_carried(&summary, &name);
            }
        }
    }
}

#[test]
fn heavier_and_slippery_object_is_neither_dropped_nor_crushed() {
    let folder = folder("carry-lift");
    let shapes = [
        "{ box = { size = [0.024, 0.024, 0.040] } }",
        "{ cylinder = { radius = 0.012, height = 0.040 } }",
    ];
    let factors = [0.4, 0.6];
    let runs = factors
        .into_iter()
        .flat_map(|factor| shapes.map(|shape| (factor, shape)));
    for (index, (factor, shape)) in runs.enumerate() {
        let settings = [
            format!("sim.object.box.shape={shape}"),
            format!("sim.fault.1.kind.friction_drop.factor={factor}"),
        ];
        let summary = carry(&folder, &format!("lift-{index}"), "lift", &settings);
        assert_carried(&summary, shape);
        // The object was lifted by 20 mm, and is on the table again at the end.
        let below = part(&summary, "highest position below the path's");
        assert!(below <= 5.0, "{shape}: {below} mm");
        let force = part(&summary, "largest grasp force of a finger");
        assert!(force <= 5.0, "{shape}: {force} N");
        // Each finger carries half of 0.12 kg, at the feelers' friction of 1.02 with 5 % of variation, times the
        // remaining factor. A lower force could not have held the object.
        let least = 0.5 * 0.12 * 9.81 / (1.02 * 1.05 * factor);
        assert!(force >= least, "{shape}: {force} N");
        // Without slip, the grip follows from the assumed friction of 0.7 with the margin of 1.6, and is below the
        // maximum. Pouring, noise and the rubber's spread of forces add at most a fifth.
        if factor == 0.6 {
            assert!(
                force <= 1.2 * 1.6 * 0.5 * 0.12 * 9.81 / 0.7,
                "{shape}: {force} N"
            );
        }
    }
}

#[test]
fn dropped_object_ends_the_task_before_the_fingers_collide() {
    let folder = folder("carry-lost");
    // Lifted high enough to fall clear of the fingers, and too slippery for a grip of 2 N.
    let settings = [
        "task.carry.crush_force=2",
        "task.carry.waypoint=[{to=[0.0,0.0,0.045],hold=9.0}]",
        "control.limits.workspace_upper=[0.06,0.04,0.16]",
        "sim.fault.1.kind.friction_drop.factor=0.2",
    ];
    let mut arguments = vec!["run", "lift", "--sensing=direct", "--out=run"];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(
        ended.stdout.contains("not as it should have: lost"),
        "{ended:?}"
    );
    let summary = summary(&folder.join("run"));
    assert_eq!(summary["outcome"], "lost");
    assert!(part(&summary, "largest grasp force of a finger") <= 2.0);
}

#[test]
fn object_is_lifted_with_image_sensing() {
    let folder = folder("carry-pictures");
    let summary = carry(&folder, "pictures", "lift", &["sensing=image".to_string()]);
    assert_eq!(summary["sensing"], "image");
    assert_carried(&summary, "with image sensing");
    assert!(part(&summary, "largest grasp force of a finger") <= 5.0);
}

#[test]
fn impossible_grips_and_unknown_objects_are_refused() {
    let folder = folder("carry-refused");
    let refused = |setting: &str, words: &[&str]| {
        run(&folder, &["run", "lift", "--set", setting]).refused(words);
    };
    refused(
        "task.carry.crush_force=0.5",
        &[
            "task.carry.crush_force = 0.5",
            "more than task.carry.grip_force",
        ],
    );
    refused(
        "task.carry.margin=0.5",
        &["task.carry.margin = 0.5", "1 to 10"],
    );
    refused(
        "task.carry.waypoint=[]",
        &["task.carry.waypoint = 0 waypoints"],
    );
    refused(
        "sim.fault.0.kind.mass_change.object=stand",
        &[
            "sim.fault[0].kind.mass_change.object = \"stand\"",
            "a free object: box",
        ],
    );
    refused(
        "sim.fault.0.kind.mass_change.mass=0.0",
        &["mass_change.mass = 0"],
    );
}
