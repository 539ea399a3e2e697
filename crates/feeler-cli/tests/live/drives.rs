//! Servo commands of the program: an emulated bus, the commands that scan and check it, and runs over it.
//!
//! One test runs the vendors' own SDKs on the emulated bus. It requires `pip install dynamixel-sdk==4.1.0
//! feetech-servo-sdk==1.0.0` in the Python named by `FEELER_PYTHON` (default `python3`). Without them the test reports
//! that it is skipped, or fails if `FEELER_REQUIRE_ALL` is set. Another one runs LeRobot's motor classes in the Python named
//! by `FEELER_LEROBOT_PYTHON`; they require `lerobot==0.6.1` without its dependencies, and the packages in `.ci/fetch`.

#![cfg(target_os = "linux")]

use crate::emulated::{Emulated, sweep};
use crate::program::{Ended, experiment, folder, run, summary};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Starts an emulated bus.
fn start_bus(folder: &Path, arguments: &[&str]) -> Emulated {
    Emulated::start(folder, &["drives", "emulate"], arguments)
}

/// The servos of the reference experiment's two fingers.
const DRIVES: &str = r#"
[drives]
port = "/dev/not-there"
baud_rate = 4000000
fast_sync_read = true
bus_watchdog = 0.1   # s
reply_timeout = 0.2  # s, as the computer may be busy
health_interval = 0.02

[[drives.finger]]
joint = [
  { id = 1, model = "XL330-M077", gear_ratio = 5.0, current_limit = 0.65 },
  { id = 2, model = "XL330-M077", gear_ratio = 5.0, direction = -1, homing_offset = 0.5 },
  { id = 3, model = "XL330-M077", gear_ratio = 5.0 },
]

[[drives.finger]]
joint = [
  { id = 4, model = "XL330-M077", gear_ratio = 5.0 },
  { id = 5, model = "XL330-M077", gear_ratio = 5.0 },
  { id = 6, model = "XL330-M077", gear_ratio = 5.0 },
]
"#;

/// Writes an experiment with [`DRIVES`] to `folder`.
fn with_drives(folder: &Path) {
    experiment(folder, "\n[sim]\n", &format!("{DRIVES}\n[sim]\n"));
}

/// Like [`with_drives`], but with long timeouts: on a busy computer, emulated servos respond late and are polled late.
fn with_patient_drives(folder: &Path) {
    let patient = DRIVES
        .replace("bus_watchdog = 0.1 ", "bus_watchdog = 2.54 ")
        .replace("reply_timeout = 0.2 ", "reply_timeout = 1.0 ");
    experiment(folder, "\n[sim]\n", &format!("{patient}\n[sim]\n"));
}

#[test]
fn servos_are_found_checked_homed_and_turned() {
    let folder = folder("drives");
    with_patient_drives(&folder);
    let bus = start_bus(&folder, &["my.toml"]);
    let port = bus.port.as_str();
    let done = |arguments: &[&str]| run(&folder, arguments).done();

    let scan = [
        "drives",
        "scan",
        port,
        "--baud-rate",
        "4000000",
        "--protocol",
        "dynamixel",
    ];
    let scanned = done(&[&scan[..], &["--largest-id", "8", "--timeout", "2"]].concat());
    assert_eq!(scanned.lines().count(), 6, "{scanned}");
    assert!(
        scanned.contains("servo 6, XL330-M077 (model 1190), 5.0 V, 25 degrees"),
        "{scanned}"
    );

    let checked = done(&["drives", "check", "my.toml", "--port", port]);
    assert!(
        checked.contains("servo 2 (theta2 of finger 0): XL330-M077, ok, at "),
        "{checked}"
    );
    assert!(
        checked.contains("will set Operating Mode (address 11) from 3 to 1"),
        "{checked}"
    );
    assert!(checked.contains("all servos passed the check"), "{checked}");

    // The hand is in its home position, so the computed offsets equal those in the file.
    let home = [
        "drives",
        "home",
        "my.toml",
        "--port",
        port,
        "--output",
        "homed.toml",
    ];
    let homed = done(&home);
    assert!(homed.contains("servo 1 (theta1 of finger 0)"), "{homed}");
    let text = std::fs::read_to_string(folder.join("homed.toml")).expect("the file");
    let text: toml::Table = text.parse().expect("TOML");
    let offset = |finger: usize, joint: usize| {
        text["drives"]["finger"][finger]["joint"][joint]["homing_offset"]
            .as_float()
            .expect("a number")
    };
    // To within one encoder count.
    assert!(
        (offset(0, 1) - 0.5).abs() < 1e-3 && offset(1, 2).abs() < 1e-3,
        "{text}"
    );
    run(&folder, &home).refused(&["homed.toml", "--force"]);
    let over_itself = [
        "drives", "home", "my.toml", "--port", port, "--output", "my.toml", "--force",
    ];
    run(&folder, &over_itself).refused(&["the file is an input"]);

    let jog = [
        "drives",
        "jog",
        "my.toml",
        "--port",
        port,
        "--set",
        "control.stale_periods=100",
    ];
    let planned = done(
        &[
            &jog[..],
            &["--finger", "1", "--joint", "2", "--by", "2", "--dry-run"],
        ]
        .concat(),
    );
    assert!(
        planned.contains("move theta2 of finger 1 by 2 deg at 3 deg/s"),
        "{planned}"
    );
    // Slow enough that the joint moves by only half a degree in the second for which commands may be late (see above).
    let slowly = [
        "--finger", "1", "--joint", "2", "--by", "-2", "--speed", "0.5",
    ];
    let turned = done(&[&jog[..], &slowly].concat());
    let degrees: Vec<f64> = turned
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let [.., from, to] = degrees[..] else {
        panic!("{turned}")
    };
    assert!((to - from + 2.0).abs() < 0.7, "{turned}");
}

/// Servos of the SCS series for the reference experiment's fingers. The middles of their ranges are at 512 counts, 150 degrees
/// of the horn.
const SCS_DRIVES: &str = r#"
[drives]
port = "/dev/not-there"
protocol = "feetech-scs"
bus_watchdog = 0.0
reply_timeout = 1.0  # s, as the computer may be busy

[[drives.finger]]
joint = [
  { id = 1, model = "SCS0009", mode = "position", homing_offset = -2.618 },
  { id = 2, model = "SCS0009", mode = "position", homing_offset = -1.833 },
  { id = 3, model = "SCS0009", mode = "position", homing_offset = -3.927 },
]

[[drives.finger]]
joint = [
  { id = 4, model = "SCS0009", mode = "position", homing_offset = -2.618 },
  { id = 5, model = "SCS0009", mode = "position", homing_offset = -3.403 },
  { id = 6, model = "SCS0009", mode = "position", homing_offset = -1.309 },
]
"#;

/// Servos of the SCS series are recognised by their model, homed without a register for it, and turned by goal positions.
#[test]
fn scs_servos_are_found_checked_homed_and_turned() {
    let folder = folder("drives-scs");
    experiment(&folder, "\n[sim]\n", &format!("{SCS_DRIVES}\n[sim]\n"));
    let bus = start_bus(&folder, &["my.toml"]);
    let with_port = |arguments: &[&str]| {
        let mut all = vec!["drives"];
        all.extend(arguments);
        all.extend(["my.toml", "--port", &bus.port]);
        run(&folder, &all)
    };
    let scan = ["drives", "scan", &bus.port, "--protocol", "feetech"];
    let options = [
        "--baud-rate",
        "1000000",
        "--largest-id",
        "6",
        "--timeout",
        "2",
    ];
    let scanned = run(&folder, &[&scan[..], &options].concat()).done();
    let found = "feetech-scs: servo 6, SCS0009 (model 1284), 5.0 V, 25 degrees Celsius, at ";
    assert_eq!(scanned.lines().count(), 6, "{scanned}");
    assert!(scanned.contains(found), "{scanned}");

    let checked = with_port(&["check"]).done();
    for line in [
        "servo 2 (theta2 of finger 0): SCS0009 in position mode, ok, at ",
        "servo 1 (theta1 of finger 0): a run will set Min Position Limit (address 9) from 0 to 307",
        "servo 1 (theta1 of finger 0): a run will set Max Position Limit (address 11) from 1023 to 717",
    ] {
        assert!(checked.contains(line), "no {line:?} in {checked}");
    }
    assert!(!checked.contains("Operating Mode"), "{checked}");

    let homed = with_port(&["home"]).done();
    let offset = |line: &str| -> f64 {
        let (_, offset) = line.split_once("homing_offset = ").expect(line);
        offset.parse().expect(line)
    };
    let offsets: Vec<_> = homed.lines().take(6).map(offset).collect();
    // To within an encoder count, 5 mrad.
    let expected = [-2.618, -1.833, -3.927, -2.618, -3.403, -1.309];
    for (offset, expected) in offsets.iter().zip(expected) {
        assert!((offset - expected).abs() < 0.006, "{homed}");
    }

    let slowly = [
        "jog",
        "--finger",
        "1",
        "--joint",
        "2",
        "--by",
        "-2",
        "--speed",
        "0.5",
        "--set",
        "control.stale_periods=100",
    ];
    let turned = with_port(&slowly).done();
    let words = turned.split_whitespace();
    let degrees: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    let [.., from, to] = degrees[..] else {
        panic!("{turned}")
    };
    assert!((to - from + 2.0).abs() < 1.0, "{turned}");

    let sweep = [
        "identify-current",
        "--finger",
        "0",
        "--joint",
        "1",
        "--loads",
        "0,0.1",
    ];
    with_port(&sweep).refused(&["feetech-scs servos measure none"]);
    with_port(&["check", "--set", "drives.finger.0.joint.0.mode=velocity"])
        .refused(&["expected \"position\", the only mode of SCS servos"]);
    with_port(&["check", "--set", "drives.baud_rate=115200"])
        .refused(&["drives.baud_rate = 115200", "control.period = 0.01 s"]);
}

#[test]
fn modes_are_checked_and_planned() {
    let folder = folder("drives-modes");
    with_patient_drives(&folder);
    let bus = start_bus(&folder, &["my.toml"]);
    let check = |settings: &[&str]| {
        let mut arguments = vec!["drives", "check", "my.toml", "--port", &bus.port];
        arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
        run(&folder, &arguments)
    };
    let limited = "drives.finger.0.joint.0.mode=current-limited-position";
    let checked = check(&[limited, "drives.finger.1.joint.2.mode=position"]).done();
    for line in [
        "servo 1 (theta1 of finger 0): XL330-M077 in current-limited-position mode, at most 0.65 A, ok, at ",
        "servo 6 (theta3 of finger 1): XL330-M077 in position mode, ok, at ",
        "servo 1 (theta1 of finger 0): a run will set Operating Mode (address 11) from 3 to 5",
        "servo 6 (theta3 of finger 1): a run will set Operating Mode (address 11) from 3 to 4",
    ] {
        assert!(checked.contains(line), "no {line:?} in {checked}");
    }
    let without_limit = "drives.finger.0.joint.1.mode=current-limited-position";
    check(&[without_limit]).refused(&[
        "joint[1].mode",
        "only with current_limit, or with torque_limit and torque",
    ]);
    let fast = check(&["drives.finger.0.joint.0.gear_ratio=100"]);
    assert_eq!(fast.status, Some(1), "{fast:?}");
    assert!(fast.stdout.contains("is limited to 38."), "{fast:?}");
    check(&["drives.finger.0.joint.0.mode=current"]).refused(&["current-limited-position"]);
    check(&["drives.finger.0.joint.0.leash=0.1"])
        .refused(&["leash = 0.1", "no value in velocity mode"]);
    check(&["drives.finger.0.joint.0.torque_limit=0.1"]).refused(&["identify-current"]);
    let torque = "drives.finger.0.joint.0.torque={ constant = 0.5, constant_error = 0.01, friction = 0, friction_error = 0 }";
    for mode in ["velocity", "position"] {
        let mode = format!("drives.finger.0.joint.0.mode=\"{mode}\"");
        check(&[&mode, torque, "drives.finger.0.joint.0.torque_limit=0.1"])
            .refused(&["torque_limit", "current-limited-position"]);
    }
    check(&["drives.bus_watchdog=0.02", "control.period=0.02"])
        .refused(&["drives.bus_watchdog = 0.02", "more than control.period"]);
}

/// The torque constant of the emulated motors is 0.215 N m / 1.47 A, their friction 2 % of 0.215 N m, and the gear ratio 5.
#[test]
fn torque_is_identified_by_sweeps_under_known_loads() {
    let folder = folder("drives-identify");
    with_patient_drives(&folder);
    let mut bus = start_bus(&folder, &["my.toml", "--fault", "-"]);
    let port = bus.port.clone();
    let identify = [
        "drives",
        "identify-current",
        "my.toml",
        "--port",
        &port,
        "--finger",
        "0",
        "--joint",
        "2",
        "--by",
        "1",
        "--speed",
        "2",
        "--sweeps",
        "3",
        "--output",
        "identified.toml",
        "--set",
        "control.stale_periods=100",
    ];
    let planned = run(
        &folder,
        &[&identify[..], &["--loads", "0,0.1", "--dry-run"]].concat(),
    )
    .done();
    assert!(
        planned.contains("sweep theta2 of finger 0 by 1 deg to either side"),
        "{planned}"
    );
    run(
        &folder,
        &[&identify[..], &["--loads", "0,0.1", "--by", "11"]].concat(),
    )
    .refused(&["--by"]);
    run(&folder, &[&identify[..], &["--loads", "0.1,0.1"]].concat())
        .refused(&["--loads", "two different"]);

    let position = || -> f64 {
        let checked = run(&folder, &["drives", "check", "my.toml", "--port", &port]).done();
        let (_, after) = checked
            .split_once("(theta2 of finger 0): XL330-M077, ok, at ")
            .expect("a joint");
        after
            .split(' ')
            .next()
            .expect("a position")
            .parse()
            .expect("a number")
    };
    let begin = position();
    let sweeps = [&identify[..], &["--loads", "0,0.1,0.2"]].concat();
    let said = sweep(&folder, &sweeps, |load| {
        // The servo turns in the other direction than the joint.
        bus.event(&format!("load=2:{}", -load / 5.0));
    });
    assert_eq!(said.matches("direction +").count(), 9, "{said}");
    // It stops where it began, to within a period's motion.
    let end = position();
    assert!((end - begin).abs() < 0.3, "from {begin} to {end} deg");
    let text = std::fs::read_to_string(folder.join("identified.toml")).expect("the file");
    let text: toml::Table = text.parse().expect("TOML");
    let torque = &text["drives"]["finger"][0]["joint"][1]["torque"];
    let value = |key: &str| torque[key].as_float().expect("a number");
    let constant = 5.0 * 0.215 / 1.47;
    assert!((value("constant") / constant - 1.0).abs() < 0.02, "{said}");
    assert!(
        (value("friction") / (0.02 * 0.215 * 5.0) - 1.0).abs() < 0.1,
        "{said}"
    );
    assert!(value("constant_error") < 0.02 * constant, "{said}");
    // The file is used.
    let check = ["drives", "check", "identified.toml", "--port", &bus.port];
    run(
        &folder,
        &[
            &check[..],
            &[
                "--set",
                "drives.finger.0.joint.1.torque_limit=0.2",
                "--set",
                "drives.finger.0.joint.1.mode=current-limited-position",
            ],
        ]
        .concat(),
    )
    .done();
}

/// Dry runs open no port and write no file.
#[test]
fn dry_runs_have_no_effect_and_invalid_arguments_are_refused() {
    let folder = folder("drives-refused");
    with_drives(&folder);
    let scan = run(&folder, &["drives", "scan", "/dev/not-there", "--dry-run"]).done();
    assert!(
        scan.contains("would ping dynamixel servos 0 to 30 on /dev/not-there at 57600 Bd"),
        "{scan}"
    );
    let check = run(&folder, &["drives", "check", "my.toml", "--dry-run"]).done();
    assert_eq!(check.matches("would read").count(), 6, "{check}");
    let home = run(
        &folder,
        &[
            "drives",
            "home",
            "my.toml",
            "--dry-run",
            "--output",
            "new.toml",
        ],
    )
    .done();
    assert!(
        home.contains("writes nothing") && !folder.join("new.toml").exists(),
        "{home}"
    );

    let refused = |arguments: &[&str], words: &[&str]| run(&folder, arguments).refused(words);
    refused(
        &["drives", "check", "my.toml"],
        &["/dev/not-there", "serial port"],
    );
    refused(
        &["drives", "check", "cap-closing"],
        &["expected a table [drives]"],
    );
    refused(
        &["drives", "home", "my.toml", "--at", "1,2"],
        &["--at", "6 positions"],
    );
    let jog = [
        "drives", "jog", "my.toml", "--finger", "0", "--joint", "1", "--by",
    ];
    refused(
        &[&jog[..], &["11"]].concat(),
        &["--by 11", "at most 10 deg"],
    );
    refused(
        &["drives", "emulate", "--fault", "fire"],
        &["--fault", "\"fire\"", "silent=ID"],
    );
    refused(
        &["drives", "emulate", "--servos=2", "--fault=silent=9"],
        &["--fault: the bus has no servo 9", "one of the ids [1, 2]"],
    );
    refused(
        &["drives", "emulate", "--set=drives.baud_rate=57600"],
        &["<EXPERIMENT>"],
    );
    let twice = ["check", "my.toml", "--set", "drives.finger.1.joint.0.id=2"];
    refused(
        &twice,
        &["drives.finger[1].joint[0].id = 2", "no other joint"],
    );
}

/// Settings for a control rate of 500 Hz with images at 100 Hz.
const FIVE_HUNDRED: &[&str] = &[
    "control.period=0.002",
    "sim.frame_period=0.01",
    "control.stale_periods=8",
];

/// Runs `experiment` over the emulated bus in lockstep and returns its summary.
fn over_the_bus(folder: &Path, experiment: &str, out: &str, settings: &[&str]) -> Value {
    let mut arguments = vec!["run", experiment, "--sensing", "direct", "--out", out];
    arguments.extend(["--drives", "emulated", "--speed", "max"]);
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    run(folder, &arguments).done();
    summary(&folder.join(out))
}

/// Cap closing with two and three fingers over servos at 4 Mbaud, commanded at 100 Hz and at 500 Hz, with images at
/// 100 Hz.
#[test]
fn all_claims_pass_over_the_emulated_bus() {
    let folder = folder("drives-claims");
    for experiment in ["cap-closing", "three-fingers"] {
        for (rate, settings) in [("100", &[][..]), ("500", FIVE_HUNDRED)] {
            let out = format!("{experiment}-{rate}");
            let summary = over_the_bus(&folder, experiment, &out, settings);
            let claims = summary["claims"].as_array().expect("claims");
            let broken = claims.iter().filter(|claim| claim["holds"] != true);
            let broken: Vec<_> = broken.collect();
            assert!(
                broken.is_empty() && claims.len() == 11,
                "{out}: {broken:#?}"
            );
        }
    }
}

/// The hand of `bench-rig` turns the cap in each position mode. At 0.03 A, since the gears take 0.029 A, it presses with
/// a fraction of the force, and the hand stops because the joints do not follow.
#[test]
fn position_modes_turn_the_cap_and_a_limited_current_limits_the_force() {
    let folder = folder("drives-position");
    let turn = |mode: &str, limit: f64| {
        let mut settings = Vec::new();
        for (finger, joint) in (0..2).flat_map(|finger| (0..3).map(move |joint| (finger, joint))) {
            let key = format!("drives.finger.{finger}.joint.{joint}");
            settings.push(format!("{key}.mode={mode}"));
            settings.push(format!("{key}.current_limit={limit}"));
        }
        let out = format!("{mode}-{limit}");
        let mut arguments = vec!["run", "bench-rig", "--sensing", "direct", "--out", &out];
        arguments.extend(["--drives", "emulated", "--speed", "max"]);
        arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
        let ended = run(&folder, &arguments);
        (ended.status, summary(&folder.join(&out)))
    };
    let peak = |summary: &Value| summary["peak_element_force"].as_f64().expect("a force");
    for mode in ["position", "current-limited-position"] {
        let (status, summary) = turn(mode, 0.6);
        assert_eq!(status, Some(0), "{mode}: {summary:#?}");
        assert!(peak(&summary) > 0.2, "{mode}: {summary:#?}");
    }
    let (status, summary) = turn("current-limited-position", 0.03);
    assert_eq!(status, Some(1), "{summary:#?}");
    assert!(peak(&summary) < 0.08, "{summary:#?}");
}

#[test]
fn runs_over_the_emulated_bus_are_reproducible() {
    let folder = folder("drives-twice");
    let stroke = ["task.screw.strokes=1"];
    let runs = ["once", "again"].map(|out| over_the_bus(&folder, "cap-closing", out, &stroke));
    assert_eq!(runs[0]["digest"], runs[1]["digest"]);
    assert!(
        runs[0]["digest"].as_str().is_some_and(|d| d.len() == 64),
        "{}",
        runs[0]
    );
}

/// Runs over a pseudo-terminal at a twentieth of real time and with long timeouts, so that a busy computer keeps up.
/// Tests only that the run lasts until its time limit; everything else is tested in lockstep.
#[test]
fn run_over_a_pseudo_terminal_lasts_until_its_time_limit() {
    let folder = folder("drives-run");
    with_patient_drives(&folder);
    let arguments = [
        "run",
        "my.toml",
        "--sensing=direct",
        "--drives=emulated",
        "--speed=0.05",
        "--set=control.stale_periods=300",
        "--set=time_limit=0.4",
        "--out=run",
    ];
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("time limit"), "{ended:?}");
}

/// Values that a vendor's SDK read on an emulated bus, or `None` if the SDKs are not installed.
fn master(folder: &Path, kind: &str) -> Option<Value> {
    let python = std::env::var("FEELER_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python)
        .args(["-c", "import dynamixel_sdk, scservo_sdk"])
        .output();
    if !probe.is_ok_and(|output| output.status.success()) {
        crate::skip::skipped(&format!(
            "{python} has no packages dynamixel-sdk and feetech-servo-sdk"
        ));
        return None;
    }
    let bus = start_bus(folder, &["--protocol", kind]);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/drives_masters.py");
    let output = Command::new(&python)
        .args([script, kind, &bus.port, "1000000"])
        .output();
    let said = Ended::of(output.expect("Python")).done();
    Some(serde_json::from_str(&said).expect("JSON"))
}

#[test]
fn vendor_sdks_work_with_the_emulated_servos() {
    let folder = folder("drives-masters");
    let Some(said) = master(&folder, "dynamixel") else {
        return;
    };
    assert_eq!(said["model"], 1200);
    assert_eq!(said["found"], serde_json::json!([1, 2, 3, 4, 5, 6]));
    // Access error, limit error, access error. Below, `after` is a range error, because the watchdog has fired.
    assert_eq!(said["refused"], serde_json::json!([7, 6, 7]));
    for velocities in ["velocities", "fast"] {
        assert_eq!(said[velocities], serde_json::json!([100, -100, 0]));
    }
    assert!(said["turned"].as_f64().expect("counts") < -300.0, "{said}");
    let rest = ["led", "watchdog", "stopped", "after", "rebooting", "torque"].map(|key| &said[key]);
    assert_eq!(
        serde_json::json!(rest),
        serde_json::json!([1, 255, 0, 4, true, 0])
    );

    // Extended position, current-based position and position within a turn. Both refusals are limit errors.
    let modes = serde_json::json!({
        "arrived_4": true, "arrived_5": true, "arrived_3": true,
        "current_4": true, "current_5": true, "current_3": true, "refused": [6, 6],
    });
    assert_eq!(said["modes"], modes);

    let said = master(&folder, "feetech").expect("the SDKs are installed");
    let expected = serde_json::json!({
        "model": 777, "missing": true, "mode": 1, "velocities": [500, -500, 0], "voltage": 50, "temperature": 25,
        "positions": { "arrived": true, "offset": -100 },
    });
    assert_eq!(said, expected);

    let said = master(&folder, "feetech-scs").expect("the SDKs are installed");
    let expected = serde_json::json!({
        "model": 1284, "sync_read": false, "limits": [430, 594], "velocities": [-40, 40, 0], "arrived": true,
        "limited": true, "voltage": 50, "temperature": 25,
    });
    assert_eq!(said, expected);
}

/// LeRobot's motor classes find, calibrate and move the emulated servos.
#[test]
fn lerobot_works_with_the_emulated_servos() {
    let folder = folder("drives-lerobot");
    let Some(python) = lerobot() else {
        return;
    };
    let operate = |kind: &str| -> Value {
        let bus = start_bus(&folder, &["--protocol", kind, "--servos", "3"]);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/drives_lerobot.py");
        let output = Command::new(&python)
            .args([script, kind, &bus.port])
            .output();
        let said = Ended::of(output.expect("Python")).done();
        serde_json::from_str(&said).expect("JSON")
    };
    let expected = serde_json::json!({
        "found": { "1": 1200, "2": 1200, "3": 1200 },
        "middle": true, "calibrated": true, "read_calibration": true, "extended": true, "limited": true, "currents": true,
        "Hardware_Error_Status": 0, "Present_Temperature": 25, "Present_Input_Voltage": 50,
    });
    assert_eq!(operate("dynamixel"), expected);
    let expected = serde_json::json!({
        "found": { "1": 777, "2": 777, "3": 777 },
        "middle": true, "calibrated": true, "read_calibration": true, "position": true, "returned": true,
        "Status": 0, "Present_Temperature": 25, "Present_Voltage": 50, "Torque_Limit": 500,
    });
    assert_eq!(operate("feetech"), expected);
    let expected = serde_json::json!({
        "found": { "1": 1284, "2": 1284, "3": 1284 },
        "middle": true, "calibrated": true, "read_calibration": true, "position": true, "returned": true,
        "Status": 0, "Present_Temperature": 25, "Present_Voltage": 50, "Lock": 1,
    });
    assert_eq!(operate("feetech-scs"), expected);
}

/// Python with LeRobot's motor classes, or `None` if it is not installed.
fn lerobot() -> Option<String> {
    let python = std::env::var("FEELER_LEROBOT_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python)
        .args(["-c", "import importlib.metadata as m; m.version('lerobot'); import dynamixel_sdk, scservo_sdk"])
        .output();
    if probe.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    crate::skip::skipped(&format!(
        "{python} has no packages lerobot, dynamixel-sdk and feetech-servo-sdk"
    ));
    None
}
