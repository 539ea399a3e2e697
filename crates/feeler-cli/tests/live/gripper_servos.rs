//! The experiment `grip` on emulated servos in simulated time, and efforts of their motors as a second opinion on the skins.

#![cfg(target_os = "linux")]

use crate::emulated::{Emulated, sweep};
use crate::program::{Ended, feeler, folder, rows, run, summary};
use feeler_record::Recording;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

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

/// Settings of a servo per jaw.
fn two_servos(settings: &[(&str, &str)]) -> Vec<String> {
    let second = [
        ("shared", "false"),
        ("id", "2"),
        ("model", "XL330-M077"),
        ("mode", "position"),
    ];
    let second = second.iter().map(|setting| (1, setting));
    let both = [0, 1].into_iter();
    let both = both.flat_map(|finger| settings.iter().map(move |setting| (finger, setting)));
    let settings = second.chain(both);
    settings
        .map(|(finger, (key, value))| format!("drives.finger.{finger}.joint.0.{key}={value}"))
        .collect()
}

/// Settings of one servo that moves both jaws.
fn one_servo(settings: &[(&str, &str)]) -> Vec<String> {
    let of_joint = ["travel_per_turn", "homing_offset"];
    let set = |(key, value): &(&str, &str)| {
        let fingers = if of_joint.contains(key) { 0..2 } else { 0..1 };
        let setting = |finger| format!("drives.finger.{finger}.joint.0.{key}={value}");
        fingers.map(setting).collect::<Vec<_>>()
    };
    settings.iter().flat_map(set).collect()
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
        ("velocity", one_servo(&velocity)),
        ("position", one_servo(&position)),
        ("limited", one_servo(&limited)),
        ("feetech", [one_servo(&feetech), bus.to_vec()].concat()),
        ("velocity-2", two_servos(&velocity)),
        ("position-2", two_servos(&position)),
        ("limited-2", two_servos(&limited)),
        ("feetech-2", [two_servos(&feetech), bus.to_vec()].concat()),
    ] {
        run_with(&folder, name, &settings).done();
        let summary = summary(&folder.join(name));
        assert_eq!(summary["outcome"], "put down", "{name}");
        let recording = Recording::read(folder.join(name).join("recording.mcap")).expect("a file");
        let efforts = recording.fingers.iter().map(|finger| finger.efforts.len());
        let steps = if name.starts_with("feetech") {
            0
        } else {
            recording.task.len()
        };
        assert!(efforts.eq([steps; 2]), "{name}");
    }
    // Simulated time: the same run each time.
    run_with(&folder, "again", &one_servo(&position)).done();
    let digest = |name: &str| summary(&folder.join(name))["digest"].clone();
    assert_eq!(digest("position"), digest("again"));
}

/// A heavy and slippery object.
const HEAVY: [&str; 3] = [
    "sim.object.box.motion.free.mass=0.3",
    "sim.object.box.friction.static_friction=0.3",
    "sim.object.box.friction.kinetic_friction=0.28",
];

/// A skin of twice the gain, and one that is numb from the start.
#[test]
fn skins_that_contradict_the_motors_stop_the_hand() {
    let folder = folder("gripper-second-opinion");
    gripper(&folder);
    for mode in ["velocity", "position"] {
        for (gain, from) in [("2", "2.5"), ("0", "0")] {
            let name = format!("{mode}-{gain}");
            let fault =
                format!("sim.fault=[{{from={from}, kind.sensor_gain={{finger=1, gain={gain}}}}}]");
            let mut settings = two_servos(&[("mode", mode), TRAVEL, TORQUE]);
            settings.extend(HEAVY.map(String::from).into_iter().chain([fault]));
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

/// One motor is compared with the sum of both skins: a numb one, both with twice the gain, and one with twice the gain, which
/// changes the sum by a third.
#[test]
fn skins_that_contradict_a_shared_motor_stop_the_hand() {
    let folder = folder("gripper-second-opinion-shared");
    gripper(&folder);
    let gain = |finger: usize, gain: f64, from: f64| {
        format!("{{from={from}, kind.sensor_gain={{finger={finger}, gain={gain}}}}}")
    };
    let run_shared = |name: &str, faults: &[String], share: f64| {
        let mut settings = one_servo(&[("mode", "position"), TRAVEL, TORQUE]);
        settings.extend(HEAVY.map(String::from));
        settings.push(format!("sim.fault=[{}]", faults.join(", ")));
        settings.push(format!("control.monitor.effort_share={share}"));
        run_with(&folder, name, &settings)
    };
    for (name, faults, share) in [
        ("numb", vec![gain(1, 0.0, 0.0)], 0.3),
        ("both", vec![gain(0, 2.0, 2.5), gain(1, 2.0, 2.5)], 0.3),
        ("one", vec![gain(1, 2.0, 2.5)], 0.1),
    ] {
        let ended = run_shared(name, &faults, share);
        assert_eq!(ended.status, Some(1), "{name}: {ended:?}");
        let words = [
            "the motor of joint 0 of finger 0 exerts ",
            "the forces on all fingertips that it moves",
        ];
        assert!(
            words.iter().all(|word| ended.stdout.contains(word)),
            "{name}: {ended:?}"
        );
        // The recorded efforts repeat the stop.
        run(&folder, &["replay", name, "--from", "forces"]).done();
    }
    run_shared("good", &[], 0.1).done();
    assert_eq!(summary(&folder.join("good"))["outcome"], "put down");
}

/// The commands for setting up a rig, with one servo that moves both jaws.
#[test]
fn a_shared_servo_is_checked_homed_and_jogged() {
    let folder = folder("gripper-shared-servo");
    gripper(&folder);
    let bus = Emulated::start(&folder, &["drives", "emulate"], &["gripper.toml"]);
    let port = ["--port", &bus.port];
    let drives =
        |arguments: &[&str]| run(&folder, &[&["drives"], arguments, &port, &PATIENT].concat());
    let checked = drives(&["check", "gripper.toml"]).done();
    let line = "servo 1 (theta1 of finger 0): XL330-M077 in position mode, ok, at ";
    assert!(
        checked.contains(line) && checked.contains(" mm, with theta1 of finger 1 at "),
        "{checked}"
    );
    assert_eq!(checked.matches("ok, at").count(), 1, "{checked}");
    assert_eq!(checked.matches("Operating Mode").count(), 1, "{checked}");

    let homed = drives(&["home", "gripper.toml", "--output", "homed.toml"]).done();
    for finger in [0, 1] {
        let line = format!("servo 1 (theta1 of finger {finger}): ");
        assert!(homed.contains(&line), "{homed}");
    }
    // The jaws are at home, so the offsets equal those in the file.
    let text = std::fs::read_to_string(folder.join("homed.toml")).expect("the file");
    let text: toml::Table = text.parse().expect("TOML");
    for finger in [0, 1] {
        let joint = &text["drives"]["finger"][finger]["joint"][0];
        let offset = joint["homing_offset"].as_float().expect("a number");
        assert!(offset.abs() < 2e-5, "{offset}");
    }

    let jog = [
        "jog",
        "gripper.toml",
        "--finger",
        "1",
        "--joint",
        "1",
        "--by",
        "1",
    ];
    let planned = drives(&[&jog[..], &["--dry-run"]].concat()).done();
    let both = "theta1 of finger 1 with theta1 of finger 0";
    assert!(planned.contains(both), "{planned}");
    let turned = drives(&[&jog[..], &["--speed", "0.5"]].concat()).done();
    assert!(turned.contains(both), "{turned}");
    let words = turned.split_whitespace();
    let millimetres: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    let [.., from, to] = millimetres[..] else {
        panic!("{turned}")
    };
    // Commands may be late by a second.
    assert!((to - from - 1.0).abs() < 0.7, "{turned}");

    let even = std::fs::read_to_string(folder.join("gripper.toml")).expect("the file");
    let travel = "shared = true, travel_per_turn = 0.0";
    assert!(even.contains(travel), "{even}");
    let uneven = even.replace(travel, "shared = true, travel_per_turn = 0.1");
    std::fs::write(folder.join("uneven.toml"), uneven).expect("a file");
    let far = ["jog", "uneven.toml", "--finger=0", "--joint=1", "--by=5"];
    drives(&far).refused(&["--by 5", "at most 10.0 mm of theta1 of finger 1"]);

    let identify = [
        "identify-current",
        "gripper.toml",
        "--joint",
        "1",
        "--loads",
        "0,1",
    ];
    drives(&[&identify[..], &["--finger", "1"]].concat())
        .refused(&["the first joint of the servo", "--finger 0 --joint 1"]);
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

/// Settings of the second jaw, with the servo of the first one.
fn second_jaw(settings: &[(&str, &str)]) -> Vec<String> {
    let setting = |(key, value): &(&str, &str)| format!("drives.finger.1.joint.0.{key}={value}");
    settings.iter().map(setting).collect()
}

/// Jaws without a common range, that close in opposite directions, at different speeds, or are not at home together.
#[test]
fn jaws_that_one_servo_cannot_move_are_refused_before_a_run() {
    let folder = folder("gripper-jaws-refused");
    gripper(&folder);
    for (settings, words) in [
        (
            &[("homing_offset", "0.2")][..],
            "a range in common with theta1 of finger 1",
        ),
        (
            &[("direction", "-1"), ("homing_offset", "0.2")],
            "a range in common with theta1 of finger 1",
        ),
        (
            &[("direction", "-1"), ("homing_offset", "0.045")],
            "theta1 of finger 1 does not close with it",
        ),
        (
            &[("direction", "-1"), ("homing_offset", "0.02")],
            "theta1 of finger 1 does not close with it",
        ),
        (
            &[("travel_per_turn", "0.03")],
            "theta1 of finger 1 closes 1.500 times as fast (allowed: 0.80 to 1.25)",
        ),
        (
            &[("homing_offset", "0.0016")],
            "with its finger at home, finger 1 is 0.0016 m from its own home (theta1): expected at most 0.0015 m",
        ),
        (
            &[("travel_per_turn", "0.024")],
            "0.0020 m from its own home",
        ),
    ] {
        let settings = second_jaw(settings);
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let check: Vec<_> = ["check", "gripper.toml"].into_iter().chain(set).collect();
        let checked = run(&folder, &check);
        let ran = run_with(&folder, "refused", &settings);
        assert_eq!(
            (checked.status, ran.status),
            (Some(2), Some(2)),
            "{settings:?}: {checked:?} {ran:?}"
        );
        assert!(checked.stderr.contains(words), "{settings:?}: {checked:?}");
        assert_eq!(checked.stderr, ran.stderr);
    }
    run(&folder, &["check", "gripper.toml"]).done();
}

/// Errors of a millimetre, or of 5 % of the travel, are usual.
#[test]
fn jaws_with_usual_errors_of_zero_and_travel_are_moved() {
    let folder = folder("gripper-jaws-differ");
    gripper(&folder);
    for (name, settings) in [
        ("zero", ("homing_offset", "0.001")),
        ("negative", ("homing_offset", "-0.001")),
        ("limit", ("homing_offset", "0.0014")),
        ("longer", ("travel_per_turn", "0.021")),
        ("shorter", ("travel_per_turn", "0.019")),
    ] {
        let ended = run_with(&folder, name, &second_jaw(&[settings]));
        assert_eq!(ended.status, Some(0), "{name}: {ended:?}");
        assert_eq!(summary(&folder.join(name))["outcome"], "put down", "{name}");
    }
}

/// A stalled jaw stops both: the message names the unit and the other joints of the motor.
#[test]
fn a_stalled_jaw_is_reported_in_metres_with_the_joints_of_its_motor() {
    let folder = folder("gripper-jaw-stalled");
    gripper(&folder);
    let fault = "sim.fault=[{from=0.5, kind.servo_stall={finger=1, joint=0}}]";
    for (name, mut settings, shared) in [("one", Vec::new(), true), ("two", two_servos(&[]), false)]
    {
        settings.push(fault.to_string());
        let ended = run_with(&folder, name, &settings);
        assert_eq!(ended.status, Some(1), "{ended:?}");
        let words = [
            " m within ",
            " m was commanded: its sensor or drive has failed, or it is blocked",
        ];
        assert!(
            words.iter().all(|word| ended.stdout.contains(word)),
            "{name}: {ended:?}"
        );
        assert!(!ended.stdout.contains(" rad "), "{name}: {ended:?}");
        assert_eq!(
            ended.stdout.contains("all joints that it moves"),
            shared,
            "{name}: {ended:?}"
        );
    }
}

/// Options of a bus that is polled late on a busy computer.
const PATIENT: [&str; 3] = [
    "--set=drives.bus_watchdog=2.54",
    "--set=drives.reply_timeout=1",
    "--set=control.stale_periods=100",
];

/// Position mode moves in a step per period, at whose end the current is lower than on average. The friction of the emulated
/// motor is 2 % of 0.215 N m: with 40 mm of travel per turn, 0.675 N.
#[test]
fn friction_identified_in_position_mode_passes_the_second_opinion() {
    let folder = folder("gripper-identified");
    gripper(&folder);
    let text = std::fs::read_to_string(folder.join("gripper.toml")).expect("a file");
    let text = text.replace("travel_per_turn = 0.02", "travel_per_turn = 0.04");
    std::fs::write(folder.join("gripper.toml"), text).expect("a file");
    let mut bus = Emulated::start(
        &folder,
        &["drives", "emulate"],
        &["gripper.toml", "--fault", "-"],
    );
    let port = bus.port.clone();
    let mut arguments = vec![
        "drives",
        "identify-current",
        "gripper.toml",
        "--port",
        &port,
    ];
    arguments.extend([
        "--finger=0",
        "--joint=1",
        "--by=4",
        "--speed=10",
        "--loads=0,1,2",
    ]);
    arguments.extend(["--output", "identified.toml"].into_iter().chain(PATIENT));
    let said = sweep(&folder, &arguments, |load| {
        bus.event(&format!("load=1:{}", load * 0.04 / std::f64::consts::TAU));
    });
    assert!(said.contains("apply a load of 2 N against"), "{said}");
    let text = std::fs::read_to_string(folder.join("identified.toml")).expect("the file");
    let table: toml::Table = text.parse().expect("TOML");
    let joint = &table["drives"]["finger"][0]["joint"][0];
    assert_eq!(joint["mode"].as_str(), Some("position"));
    let friction = joint["torque"]["friction"].as_float().expect("a number");
    assert!((friction / 0.675 - 1.0).abs() < 0.1, "{friction} N: {said}");
    std::fs::write(folder.join("gripper.toml"), text).expect("a file");
    run_with(&folder, "run", &[]).done();
    assert_eq!(summary(&folder.join("run"))["outcome"], "put down");
}

#[test]
fn a_jog_by_zero_is_refused_and_a_lost_bus_may_leave_torque_on() {
    let folder = folder("gripper-jog-lost");
    gripper(&folder);
    let emulate = ["gripper.toml", "--log", "bus.csv"];
    let bus = Emulated::start(&folder, &["drives", "emulate"], &emulate);
    let port = bus.port.clone();
    let mut jog = vec!["drives", "jog", "gripper.toml", "--port", &port];
    jog.extend(
        ["--finger=0", "--joint=1", "--speed=0.5"]
            .into_iter()
            .chain(PATIENT),
    );
    run(&folder, &[&jog[..], &["--by=0"]].concat())
        .refused(&["--by 0", "expected a value other than 0"]);
    let fast = [
        "--by=1",
        "--set=drives.finger.1.joint.0.travel_per_turn=0.04",
        "--speed=6",
    ];
    let fast: Vec<_> = jog
        .iter()
        .filter(|option| **option != "--speed=0.5")
        .chain(&fast)
        .copied()
        .collect();
    run(&folder, &fast).refused(&["--speed 6", "at most 5.0 mm/s"]);

    let mut command = feeler(&folder, &[&jog[..], &["--by=10"]].concat());
    let jogging = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut jogging = jogging.expect("the program");
    // The jog takes 20 s. A goal after its torque was enabled shows that it has begun.
    let log = folder.join("bus.csv.part");
    let moves = || {
        let log = std::fs::read_to_string(&log).unwrap_or_default();
        let enabled = log.split_once(",write,400001");
        enabled.is_some_and(|(_, after)| after.contains("sync_write,7400"))
    };
    while !moves() {
        assert!(jogging.try_wait().expect("its status").is_none());
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(bus);
    let ended = Ended::of(jogging.wait_with_output().expect("its end"));
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(
        ended.stderr.contains("torque may still be enabled"),
        "{ended:?}"
    );
}
