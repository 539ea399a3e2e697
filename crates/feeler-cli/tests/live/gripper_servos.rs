//! The experiment `grip` on emulated servos in simulated time, and efforts of their motors as a second opinion on the skins.

#![cfg(target_os = "linux")]

use crate::program::{Ended, folder, rows, run, summary};
use feeler_record::Recording;
use std::path::Path;

/// Writes the experiment `grip` with its servos to `gripper.toml` in `folder`.
fn gripper(folder: &Path) {
    run(
        folder,
        &["init", "gripper.toml", "--from", "grip", "--full"],
    )
    .done();
    let grip = std::fs::read_to_string(folder.join("gripper.toml")).expect("a file");
    let servos = include_str!("../../../feeler-lab/experiments/grip.servos.toml");
    std::fs::write(folder.join("gripper.toml"), format!("{grip}\n{servos}")).expect("a file");
}

/// Settings of both joints.
fn joints(settings: &[(&str, &str)]) -> Vec<String> {
    let joints = [0, 1].map(|finger| format!("drives.finger.{finger}.joint.0"));
    let settings = settings.iter();
    settings
        .flat_map(|(key, value)| {
            joints
                .iter()
                .map(move |joint| format!("{joint}.{key}={value}"))
        })
        .collect()
}

/// Travel of a jaw with little friction.
const TRAVEL: (&str, &str) = ("travel_per_turn", "0.04");

/// Calibration of the emulated XL330-M077 with [`TRAVEL`]: 0.215 N m / 1.47 A and friction of 2 % of that torque, and errors
/// of a percent and a tenth.
const TORQUE: (&str, &str) = (
    "torque",
    "{constant=23.2, constant_error=0.23, friction=0.61, friction_error=0.06}",
);

fn run_with(folder: &Path, name: &str, settings: &[String]) -> Ended {
    let mut arguments = vec![
        "run",
        "gripper.toml",
        "--drives=emulated",
        "--speed=max",
        "--out",
        name,
    ];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    run(folder, &arguments)
}

#[test]
fn objects_are_held_by_servos_in_every_mode_without_false_alarms() {
    let folder = folder("gripper-servos");
    gripper(&folder);
    let velocity = [("mode", "velocity"), TRAVEL, TORQUE];
    let position = [("mode", "position"), TRAVEL, TORQUE];
    let limited = [
        ("mode", "current-limited-position"),
        ("current_limit", "0.5"),
        TRAVEL,
        TORQUE,
    ];
    // 30 kg cm at 3.25 A, with 125 mm of travel per turn. The middle of the travel is far from the wrap.
    let feetech = [
        ("model", "STS3215"),
        ("travel_per_turn", "0.125"),
        ("homing_offset", "-0.04"),
    ];
    let bus = ["protocol=feetech", "bus_watchdog=0", "fast_sync_read=false"];
    let bus = bus.map(|setting| format!("drives.{setting}"));
    for (name, settings) in [
        ("velocity", joints(&velocity)),
        ("position", joints(&position)),
        ("limited", joints(&limited)),
        ("feetech", [joints(&feetech), bus.to_vec()].concat()),
    ] {
        run_with(&folder, name, &settings).done();
        let summary = summary(&folder.join(name));
        assert_eq!(summary["outcome"], "put down", "{name}");
        let recording = Recording::read(folder.join(name).join("recording.mcap")).expect("a file");
        let efforts = recording.fingers.iter().map(|finger| finger.efforts.len());
        let steps = if name == "feetech" {
            0
        } else {
            recording.task.len()
        };
        assert!(efforts.eq([steps; 2]), "{name}");
    }
    // Simulated time: the same run each time.
    run_with(&folder, "again", &joints(&position)).done();
    let digest = |name: &str| summary(&folder.join(name))["digest"].clone();
    assert_eq!(digest("position"), digest("again"));
}

/// A skin of twice the gain, and one that is numb from the start.
#[test]
fn skins_that_contradict_the_motors_stop_the_hand() {
    let folder = folder("gripper-second-opinion");
    gripper(&folder);
    let heavy = [
        "sim.object.box.motion.free.mass=0.3",
        "sim.object.box.friction.static_friction=0.3",
        "sim.object.box.friction.kinetic_friction=0.28",
    ];
    for mode in ["velocity", "position"] {
        for (gain, from) in [("2", "2.5"), ("0", "0")] {
            let name = format!("{mode}-{gain}");
            let fault =
                format!("sim.fault=[{{from={from}, kind.sensor_gain={{finger=1, gain={gain}}}}}]");
            let mut settings = joints(&[("mode", mode), TRAVEL, TORQUE]);
            settings.extend(heavy.map(String::from).into_iter().chain([fault]));
            let ended = run_with(&folder, &name, &settings);
            assert_eq!(ended.status, Some(1), "{ended:?}");
            assert!(
                ended
                    .stdout
                    .contains("the motor of joint 0 of finger 1 exerts "),
                "{name}: {ended:?}"
            );
            // The recorded efforts repeat the stop.
            run(&folder, &["replay", &name, "--from", "forces"]).done();
        }
    }
}

#[test]
fn servos_are_compared_on_the_same_objects() {
    let folder = folder("gripper-servos-compared");
    gripper(&folder);
    let compare = [
        "compare",
        "gripper.toml",
        "--trials=2",
        "--laws=partial-slip",
    ];
    run(&folder, &[&compare[..], &["-o=direct"]].concat()).done();
    let on_bus = ["--drives=emulated", "-o=bus"];
    let text = run(&folder, &[&compare[..], &on_bus].concat()).done();
    assert!(text.contains("median time to more force"), "{text}");
    let [direct, bus] =
        ["direct", "bus"].map(|name| rows(&folder.join(name).join("partial-slip.csv")));
    assert_eq!((direct.len(), bus.len()), (2, 2));
    for (direct, bus) in direct.iter().zip(&bus) {
        assert_eq!(direct["trial"], bus["trial"]);
        assert_eq!(bus["outcome"], "put down");
        // The same object, moved by other drives.
        assert_ne!(direct["mean_grip_n"], bus["mean_grip_n"]);
    }
    let cap = ["compare", "cap-closing", "--drives=emulated", "-o=cap"];
    run(&folder, &cap).refused(&["--drives", "task.grip"]);
}
