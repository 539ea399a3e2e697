//! A gripper that takes unknown objects, holds them while an arm carries them, and puts them down.

use crate::program::{folder, part, rows, run, summary};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Policies that `examples/python/train_grip_policy.py` made, with and without touch.
const POLICIES: [&str; 2] = ["grip-touch", "grip-blind"];

/// Copies the file `name` of `examples/python` to `folder`.
fn copy_policy(folder: &Path, name: &str) {
    let file = format!("{name}.safetensors");
    let examples = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/python"
    ));
    fs::copy(examples.join(&file), folder.join(file)).expect("a policy");
}

/// Runs the experiment `grip` with `settings`, and returns the `summary.json` of the run.
fn grip(folder: &Path, name: &str, settings: &[&str]) -> Value {
    let mut arguments = vec!["run", "grip", "--out", name];
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    run(folder, &arguments).done();
    summary(&folder.join(name))
}

#[test]
fn an_unknown_object_is_held_until_it_is_put_down() {
    let folder = folder("grip-run");
    let heavier = [
        "sim.object.box.motion.free.mass=0.2",
        "sim.fault.1.kind.mass_change.mass=0.3",
    ];
    let slippery = [
        "sim.object.box.friction.static_friction=0.3",
        "sim.object.box.friction.kinetic_friction=0.28",
    ];
    let round = ["sim.object.box.shape={ cylinder = { radius = 0.015, height = 0.06 } }"];
    for (name, settings, friction) in [
        ("as-it-is", &[][..], [0.46, 0.5]),
        ("heavier", &heavier, [0.46, 0.5]),
        ("slippery", &slippery, [0.28, 0.3]),
        ("round", &round, [0.46, 0.5]),
    ] {
        let summary = grip(&folder, name, settings);
        assert_eq!(summary["outcome"], "put down", "{name}");
        assert_eq!(part(&summary, "put down"), 1.0, "{name}");
        assert!(part(&summary, "largest displacement relative to the gripper") < 15.0);
        let found = summary["findings"]["friction"]
            .as_f64()
            .expect("a friction");
        // Between kinetic and static, within a tenth: the estimate is meant to be a lower bound with some noise.
        let [low, high] = [0.9 * friction[0], 1.1 * friction[1]];
        assert!((low..high).contains(&found), "{name}: friction {found}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let folder = folder("grip-digest");
    let [first, second] = ["first", "second"].map(|name| grip(&folder, name, &["seed=3"]));
    assert_eq!(first["digest"], second["digest"]);
    assert!(first["digest"].is_string());
}

#[test]
fn every_law_ends_and_a_missing_object_is_reported() {
    let folder = folder("grip-laws");
    for law in ["reflex", "missing-shear", "drag", "known-friction", "fixed"] {
        let summary = grip(&folder, law, &[&format!("task.grip.law={law}")]);
        assert_eq!(summary["outcome"], "put down", "{law}");
    }
    let far = "sim.object.box.position=[0.0, 0.055, 0.1]";
    let arguments = ["run", "grip", "--out", "nothing", "--set", far];
    let workspace = "--set=control.limits.workspace_upper=[0.06, 0.06, 0.11]";
    let ended = run(&folder, &[&arguments[..], &[workspace]].concat());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("without a grasp"), "{ended:?}");
}

#[test]
fn laws_are_compared_on_the_same_objects() {
    let folder = folder("grip-compare");
    let arguments = [
        "compare",
        "grip",
        "--trials=3",
        "--laws=partial-slip,fixed",
        "--least-grip",
        "-o=compared",
    ];
    let text = run(&folder, &arguments).done();
    for words in ["partial-slip", "fixed", "dropped (%)", "compare.html"] {
        assert!(text.contains(words), "{text}");
    }
    let [own, fixed] =
        ["partial-slip", "fixed"].map(|law| rows(&folder.join(format!("compared/{law}.csv"))));
    assert_eq!((own.len(), fixed.len()), (3, 3));
    for (own, fixed) in own.iter().zip(&fixed) {
        let number = |row: &std::collections::HashMap<String, String>, name: &str| {
            row[name].parse::<f64>().expect("a number")
        };
        // The same object, and a grip that need not know it.
        assert_eq!(own["crush_force_n"], fixed["crush_force_n"]);
        assert!(number(fixed, "mean_grip_n") > number(own, "mean_grip_n"));
        // No grip holds with less than the load over twice the static friction: less the few milliseconds in which a lift
        // begins or ends.
        assert_eq!(own["least_grip_n"], fixed["least_grip_n"]);
        let least = number(own, "least_grip_n");
        assert!(least > 0.98 * number(own, "mean_load_grip_n"));
        assert!(number(fixed, "mean_grip_n") > 2.0 * least);
    }
    // An existing result is not overwritten.
    run(&folder, &arguments).refused(&["compared", "expected another folder"]);
    run(
        &folder,
        &["compare", "grip", "--laws=fixed,fixed", "-o=other"],
    )
    .refused(&["--laws: fixed is given twice"]);
    let unknown = ["compare", "grip", "--laws=firm", "-o=other"];
    run(&folder, &unknown).refused(&["firm", "partial-slip"]);
    run(&folder, &["compare", "grip", "--resume", "-o=other"]).refused(&["--resume"]);
    run(
        &folder,
        &["compare", "cap-closing", "--least-grip", "-o=other"],
    )
    .refused(&["--least-grip"]);
    for (setting, words) in [
        ("task.grip.law=firm", "partial-slip"),
        ("task.grip.max_force=0.1", "grip_force"),
        ("sim.arm.0.until=1.0", "sim.arm[0]"),
        ("sim.fault.0.kind.pull.object=cup", "cup"),
    ] {
        run(&folder, &["run", "grip", "--set", setting]).refused(&[words]);
    }
}

#[test]
fn policies_grip_the_same_objects_and_are_deterministic() {
    let folder = folder("grip-policies");
    for name in POLICIES {
        copy_policy(&folder, name);
    }
    let compare = |out: &str| {
        let arguments = [
            "compare",
            "grip",
            "--policy=grip-blind.safetensors",
            "--policy=grip-touch.safetensors",
            "--trials=4",
            "--seed=3",
            "--out",
            out,
        ];
        let text = run(&folder, &arguments).done();
        let table = |name: &str| fs::read_to_string(folder.join(format!("{out}/{name}.csv")));
        (text, POLICIES.map(|name| table(name).expect("a table")))
    };
    let (text, [touch, blind]) = compare("first");
    assert!(text.contains("grip-touch compared with grip-blind, in percentage points: dropped"));
    assert_ne!(touch, blind);
    assert_eq!(compare("second").1, [touch, blind]);
    for name in POLICIES {
        for row in rows(&folder.join(format!("first/{name}.csv"))) {
            assert_eq!(
                row["outcome"] == "lost",
                row["outcome"] != "put down",
                "{row:?}"
            );
        }
    }
}

#[test]
fn a_policy_holds_the_object_and_its_recording_replays() {
    let folder = folder("grip-policy-run");
    copy_policy(&folder, "grip-touch");
    let law = "control.law.policy.file=grip-touch.safetensors";
    let summary = grip(&folder, "run", &["task.grip.law=policy", law]);
    assert_eq!(summary["outcome"], "put down");
    let replay = ["replay", "run", "--from=forces"];
    assert!(run(&folder, &replay).done().contains("bit for bit"));
}

#[test]
fn policies_that_do_not_fit_the_gripper_are_refused() {
    let folder = folder("grip-policy-refused");
    copy_policy(&folder, "cap-closing");
    copy_policy(&folder, "grip-touch");
    fs::write(folder.join("fixed.safetensors"), "a law's name").expect("a file");
    let compare = |more: &[&str]| run(&folder, &[&["compare", "grip", "-o=c"], more].concat());
    compare(&["--policy=cap-closing.safetensors"]).refused(&[
        "cap-closing.safetensors",
        "expected a policy for fingers of 1 joints",
        "for 3",
    ]);
    compare(&["--policy=gone.safetensors"]).refused(&["gone.safetensors", "No such file"]);
    compare(&["--laws=fixed", "--policy=fixed.safetensors"]).refused(&["fixed is that of a law"]);
    assert!(!folder.join("c").exists());
    let file = "--set=control.law.policy.file=grip-touch.safetensors";
    let law = "--set=task.grip.law=policy";
    run(&folder, &["check", "grip", file])
        .refused(&["control.law", "task.grip with law = \"policy\""]);
    run(&folder, &["check", "grip", law]).refused(&["control.law.policy with a file"]);
    run(&folder, &["check", "grip", law, file]).done();
}
