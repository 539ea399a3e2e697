//! Skins of the program: emulated ones, the commands that list, sense and record them, and the vendors' packages.
//!
//! One test reads emulated skins with the vendors' own packages. It requires `pip install anyskin==1.0.0
//! reskin-sensor==2.0.2 flexitac==0.3.1` in the Python named by `FEELER_PYTHON` (default `python3`).

#![cfg(target_os = "linux")]

use crate::emulated::Emulated;
use crate::program::{Ended, feeler, folder, rows, run};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};

/// Starts an emulated skin.
fn start_skin(folder: &Path, arguments: &[&str]) -> Emulated {
    Emulated::start(folder, &["skins", "emulate", "--event=-"], arguments)
}

/// A program that senses a skin to standard output, as JSON Lines or a table.
struct Sense {
    child: Child,
    lines: std::io::Lines<BufReader<std::process::ChildStdout>>,
    keys: ChildStdin,
}

impl Sense {
    fn start(folder: &Path, port: &str, arguments: &[&str]) -> Self {
        let source = format!("serial:{port}");
        let mut child = feeler(folder, &["sense", &source])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program");
        let stdout = child.stdout.take().expect("its output");
        Self {
            keys: child.stdin.take().expect("its input"),
            lines: BufReader::new(stdout).lines(),
            child,
        }
    }

    /// Waits for a row of element `element` whose compression satisfies `is_met`; `None` is an unknown force.
    fn wait_for(&mut self, element: &str, is_met: impl Fn(Option<f64>) -> bool) {
        for line in self.lines.by_ref() {
            let line = line.expect("text");
            let cells: Vec<_> = line.split(',').collect();
            if cells.get(2) == Some(&element) && is_met(cells[5].parse().ok()) {
                return;
            }
        }
        panic!("the program ended");
    }

    /// Presses Ctrl-C, and returns the standard error.
    fn interrupt(mut self) -> String {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &id]).status();
        assert!(sent.expect("the kill command").success());
        // The program may be writing.
        self.lines.by_ref().for_each(drop);
        let ended = Ended::of(self.child.wait_with_output().expect("its end"));
        assert_eq!(ended.status, Some(1), "{ended:?}");
        ended.stderr
    }
}

#[test]
fn a_live_skin_is_sensed_zeroed_unplugged_and_back() {
    let folder = folder("skins-live");
    let mut skin = start_skin(&folder, &["anyskin", "--link=skin.port"]);
    assert_eq!(skin.port, "skin.port");
    let mut sense = Sense::start(&folder, &skin.port, &["--taxels=anyskin"]);
    let quiet = |z: Option<f64>| z.is_some_and(|z| z.abs() < 5.0);
    sense.wait_for("0", quiet);
    skin.event("press=200");
    sense.wait_for("0", |z| z.is_some_and(|z| (z - 200.0).abs() < 5.0));
    // Enter measures the zero again.
    writeln!(sense.keys).expect("the program");
    sense.wait_for("0", |z| z.is_none());
    sense.wait_for("0", quiet);
    skin.event("lose-bytes=0.005");
    skin.event("unplug=0.5");
    sense.wait_for("0", |z| z.is_none());
    sense.wait_for("0", quiet);
    skin.event("silent=0.5");
    sense.wait_for("0", |z| z.is_none());
    sense.wait_for("0", quiet);
    skin.event("press=0");
    sense.wait_for("0", |z| z.is_some_and(|z| (z + 200.0).abs() < 5.0));
    let said = sense.interrupt();
    for words in [
        "forces are in counts",
        "press Enter",
        "disconnected",
        "connected again",
        "sends no frames",
        "serial:skin.port:",
        "1 reconnections",
    ] {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
}

/// A recorded table gives the forces that the live skin would have given.
#[test]
fn a_recorded_skin_is_sensed_like_a_table() {
    let folder = folder("skins-record");
    for (name, elements) in [("anyskin", 5), ("paxini-s1813e", 31)] {
        let skin = start_skin(&folder, &[name, "--event=press=50"]);
        let table = format!("{name}.csv");
        let taxels = format!("--taxels={name}");
        let record = [
            "skins",
            "record",
            &skin.port,
            &taxels,
            "--seconds=0.5",
            "-o",
            &table,
        ];
        let ended = run(&folder, &record);
        assert_eq!(ended.status, Some(0), "{ended:?}");
        assert!(ended.stderr.contains("0 losses"), "{ended:?}");
        let raw = rows(&folder.join(&table));
        assert!(raw.len() > 10, "{} rows", raw.len());
        let ended = run(
            &folder,
            &["sense", &table, &taxels, "-o", "forces.csv", "--force"],
        );
        assert_eq!(ended.status, Some(0), "{ended:?}");
        let forces = rows(&folder.join("forces.csv"));
        assert_eq!(forces.len(), raw.len() * elements);
        let stamps: Vec<f64> = raw.iter().map(|row| row["time"].parse().unwrap()).collect();
        assert!(stamps.is_sorted(), "{stamps:?}");
    }
    let refused = [
        "skins",
        "record",
        "/dev/not-there",
        "--taxels=anyskin",
        "-o",
        "no.csv",
    ];
    run(&folder, &refused).refused(&["/dev/not-there", "feeler skins"]);
    assert!(!folder.join("no.csv").exists() && !folder.join("no.csv.part").exists());
}

#[test]
fn skins_are_listed() {
    let folder = folder("skins-list");
    let anyskin = start_skin(&folder, &["anyskin"]);
    let paxini = start_skin(&folder, &["paxini-s1813e"]);
    let ended = run(
        &folder,
        &["skins", &anyskin.port, &paxini.port, "/dev/not-there"],
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let [first, second, third] = ended.stdout.lines().collect::<Vec<_>>()[..] else {
        panic!("{ended:?}");
    };
    for words in [
        "magnetometers, 5 taxels",
        "Hz",
        "--taxels eflesh or anyskin or reskin",
    ] {
        assert!(first.contains(words), "{first}");
    }
    assert!(
        second.contains("PaXini module at address 1") && second.contains("paxini-s1813e"),
        "{second}"
    );
    assert!(third.starts_with("/dev/not-there: "), "{third}");
}

#[test]
fn options_without_effect_are_refused() {
    let folder = folder("skins-refused");
    let refused = |arguments: &[&str], words: &[&str]| run(&folder, arguments).refused(words);
    refused(&["sense", "serial:/dev/x"], &["--taxels", "feeler list"]);
    refused(
        &["sense", "serial:", "--taxels=anyskin"],
        &["serial:/dev/ttyACM0"],
    );
    refused(
        &["sense", "serial:/dev/x", "--taxels=anyskin"],
        &["serial:/dev/x", "feeler skins"],
    );
    refused(
        &["sense", "serial:/dev/x", "--taxels=uskin-4x4"],
        &["[serial]", "magnetometers"],
    );
    refused(
        &["sense", "serial:/dev/x", "--taxels=anyskin", "--rate=5"],
        &["--rate"],
    );
    refused(
        &[
            "sense",
            "serial:/dev/x",
            "--taxels=anyskin",
            "--prefix=left",
        ],
        &["--prefix"],
    );
    refused(
        &["skins", "emulate", "anyskin", "--event=fire=1"],
        &["fire", "press=COUNTS"],
    );
    refused(&["skins", "emulate", "uskin-4x4"], &["[serial]"]);
}

/// Means of readings by a vendor's package, or `None` if it is not installed.
fn read_by_vendor(folder: &Path, package: &str, layout: &str) -> Option<Vec<Vec<f64>>> {
    let python = std::env::var("FEELER_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python)
        .args(["-c", "import anyskin, reskin_sensor, flexitac"])
        .output();
    if !probe.is_ok_and(|output| output.status.success()) {
        crate::skip::skipped(&format!(
            "{python} has no packages anyskin, reskin-sensor and flexitac"
        ));
        return None;
    }
    let skin = start_skin(folder, &[layout]);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/skins_vendors.py");
    let output = Command::new(&python)
        .args([script, package, &skin.port])
        .output();
    let ended = Ended::of(output.expect("Python"));
    assert_eq!(ended.status, Some(0), "{ended:?}");
    Some(serde_json::from_str(&ended.stdout).expect("JSON"))
}

/// The vendors' packages read what feeler reads: the constants of the emulated skins at rest.
#[test]
fn vendor_packages_read_the_emulated_skins() {
    let folder = folder("skins-vendors");
    for (package, layout) in [
        ("anyskin", "anyskin"),
        ("reskin", "reskin"),
        ("reskin", "eflesh"),
    ] {
        let Some(chips) = read_by_vendor(&folder, package, layout) else {
            return;
        };
        assert_eq!(chips.len(), 5);
        for (chip, means) in (0_u8..).zip(&chips) {
            let step = f64::from(chip);
            let expected = [25.0, 120.0 - 35.0 * step, 60.0 * step - 90.0, 900.0];
            let close = means
                .iter()
                .zip(expected)
                .all(|(mean, expected)| (mean - expected).abs() < 0.5);
            assert!(close, "{package}, chip {chip}: {means:?}");
        }
    }
    let image =
        read_by_vendor(&folder, "flexitac", "flexitac").expect("the packages are installed");
    assert_eq!((image.len(), image[0].len()), (12, 32));
    for (taxel, mean) in image.iter().flatten().enumerate() {
        let expected = 10.0 + (7 * taxel % 20) as f64;
        assert!((mean - expected).abs() < 0.5, "{taxel}: {mean}");
    }
}
