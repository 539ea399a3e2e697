//! LeRobot finds the plug-in `lerobot_robot_feeler` by name, and moves a simulated hand and the hand of a rig with it.
//!
//! Requires the Python named by `FEELER_LEROBOT_PYTHON` with `lerobot==0.6.1`, without its dependencies, and the packages
//! in `.ci/fetch`, including the plug-in: `pip install --no-deps -e python/lerobot_robot_feeler`. Without them the tests
//! report that they are skipped, or fail if `FEELER_REQUIRE_ALL` is set.

use crate::program::{feeler, folder};
use crate::rig::Running;
use feeler_record::Recording;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// Velocity that the script requests of joint 2 of finger 0 (rad/s).
const SPEED: f64 = 0.05;

/// Python with LeRobot and the plug-in, or `None` if it is not installed.
fn lerobot() -> Option<String> {
    let python = std::env::var("FEELER_LEROBOT_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe =
        "import importlib.metadata as m; m.version('lerobot'); m.version('lerobot_robot_feeler')";
    let probe = Command::new(&python).args(["-c", probe]).output();
    if probe.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    let missing = format!("{python} has no packages lerobot and lerobot_robot_feeler");
    crate::skip::skipped(&missing);
    None
}

/// Runs the script with these arguments, calls `end_rig` when it permits the rig to end, and returns what it printed.
fn operate(folder: &Path, python: &str, arguments: &[&str], end_rig: impl FnOnce()) -> Value {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/lerobot_plugin.py");
    let mut child = Command::new(python)
        .args([script, env!("CARGO_BIN_EXE_feeler"), "cap-closing"])
        .args(["--sensing=direct", "--out=run"])
        .args(arguments)
        .env("HF_HOME", folder.join("hugging-face"))
        .current_dir(folder)
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python");
    let mut end_rig = Some(end_rig);
    let mut said = String::new();
    for line in BufReader::new(child.stdout.take().expect("its output")).lines() {
        said = line.expect("text");
        if said == "the rig may end" {
            end_rig.take().expect("one such line")();
        }
    }
    assert!(child.wait().expect("its end").success(), "{said}");
    serde_json::from_str(&said).expect("JSON")
}

/// Checks the results that a simulated hand and a rig have in common.
fn check(said: &Value) {
    assert_eq!(said["class"], "lerobot_robot_feeler.feeler_hand.FeelerHand");
    assert_eq!(
        (&said["name"], &said["type"]),
        (&json!("feeler"), &json!("feeler"))
    );
    for error in said["unconnected"].as_array().expect("errors") {
        assert!(
            error
                .as_str()
                .expect("an error")
                .contains("DeviceNotConnectedError"),
            "{error}"
        );
    }
    let joints = (0..2).flat_map(|finger| (1..4).map(move |joint| (finger, joint)));
    let actions: Vec<_> = joints
        .map(|(f, j)| format!("finger_{f}_joint_{j}.vel"))
        .collect();
    assert_eq!(said["actions"], json!(actions));
    // Six joints; for each finger 41 forces, three flags, grasp force and age.
    assert_eq!(
        said["data_set"]["observation.state"],
        json!([[6 + 2 * (41 * 3 + 5)], "float32"])
    );
    assert_eq!(said["data_set"]["action"], json!([[6], "float32"]));
    assert_eq!(said["arrays"]["observation.state"], json!([[6], "float32"]));
    assert_eq!(
        said["arrays"]["observation.tactile.finger_1.force"],
        json!([[41, 3], "float32"])
    );
    assert_eq!(
        said["arrays"]["observation.tactile.finger_1.flags"],
        json!([[3], "bool"])
    );
    for fact in ["calibrated", "keys", "frame", "disconnected"] {
        assert_eq!(said[fact], true, "{fact}: {said}");
    }
    let number = |key: &str| said[key].as_f64().expect("a number");
    assert!((number("sent") + SPEED).abs() < 1e-6, "{said}");
    assert!(number("others") < 1e-6, "{said}");
    // Half a second and the lifetime of the last action, reduced by the drives' lag and late actions.
    assert!((-0.04..-0.01).contains(&number("moved")), "{said}");
    assert!(number("stands") < 1e-3, "{said}");
    let limited = number("limited");
    assert!((-10.0..-1e-3).contains(&limited), "{said}");
    let refused = [
        "finger_0_joint_1.vel is missing",
        "expected a finite velocity",
    ];
    for (error, words) in said["refused"]
        .as_array()
        .expect("errors")
        .iter()
        .zip(refused)
    {
        assert!(error.as_str().expect("an error").contains(words), "{error}");
    }
}

#[test]
fn lerobot_moves_a_simulated_hand() {
    let Some(python) = lerobot() else { return };
    let folder = folder("lerobot-simulated");
    let said = operate(&folder, &python, &["--simulated"], || {});
    check(&said);
    assert_eq!(
        said["twice"],
        "DeviceAlreadyConnectedError: test FeelerHand is already connected."
    );
    for error in said["lost"].as_array().expect("errors") {
        assert!(
            error.as_str().expect("an error").contains("ProgramError: "),
            "{error}"
        );
    }
}

#[test]
fn lerobot_moves_the_hand_of_a_rig_and_refuses_stale_data() {
    let Some(python) = lerobot() else { return };
    let folder = folder("lerobot-rig");
    let _alone = crate::rig::alone();
    let endpoint = crate::ports::unused_endpoint();
    let patient = "control.stale_periods=100";
    let start = |name: &str, arguments: &[&str]| {
        let mut command = feeler(&folder, arguments);
        command.args(["--sensing=direct", "--connect", &endpoint, "--set", patient]);
        Running::start(&folder, name, command)
    };
    let mut rig = start("world", &["world", "cap-closing"]);
    let _senses = ["0", "1"].map(|finger| {
        let arguments = ["sense", "rig:", "--finger", finger, "--publish"];
        start(&format!("sense-{finger}"), &arguments)
    });
    let arguments = ["--listen", &endpoint, "--set", patient];
    let said = operate(&folder, &python, &arguments, || rig.kill());
    check(&said);
    let stale = said["stale"].as_str().expect("an error");
    assert!(stale.starts_with("StaleObservationError: "), "{said}");
    assert!(stale.contains("s old, expected at most 1.0 s"), "{said}");
    let stopped = said["stopped"].as_str().expect("an error");
    assert!(
        stopped.starts_with("HandStoppedError: the hand is stopped"),
        "{said}"
    );
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    let joints = &recording.fingers[0].joints;
    let positions = joints.iter().map(|joints| joints.position[1]);
    let lowest = positions.fold(f64::INFINITY, f64::min);
    assert!(joints[0].position[1] - lowest > 0.01, "{lowest}");
}
