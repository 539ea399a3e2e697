//! `feeler verify`, and `feeler calibrate --from` for a second copy of a sensor.

use crate::program::{Ended, folder, run};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Rows per press, at 20 Hz; the load is zero in the last quarter.
const ROWS: u32 = 40;

/// Writes `NAME.csv`, a table of a skin of 5 taxels whose sensitivity is `gain` times that of the original, and
/// `NAME.forces.csv` with the forces of `presses` presses of 4 to 10 N.
fn press(folder: &Path, name: &str, presses: u32, gain: f64) {
    let names = (0..5).flat_map(|n| ["x", "y", "z"].map(|axis| format!(",{n}_{axis}")));
    let mut table = "t".to_owned() + &names.collect::<String>() + "\n";
    let mut forces = String::from("recording,time,f_z\n");
    for row in 0..presses * ROWS {
        let time = f64::from(row) / 20.0;
        let peak = 7.0 + 3.0 * f64::from(row / ROWS).sin();
        let part = f64::from(row % ROWS) / f64::from(ROWS) / 0.75;
        // Starts without load for the zero, and ends each press so.
        let load = if part >= 1.0 {
            0.0
        } else {
            peak * (TAU * part / 2.0).sin()
        };
        writeln!(forces, "{name}.csv,{time},{load}").unwrap();
        write!(table, "{time}").unwrap();
        for n in 0..15 {
            let noise = (f64::from(row * 15 + n) * 77.7).sin();
            let count = 500.0 + gain * load * 40.0 * f64::from(n).cos() + noise;
            write!(table, ",{count:.1}").unwrap();
        }
        table += "\n";
    }
    fs::write(folder.join(format!("{name}.csv")), table).unwrap();
    fs::write(folder.join(format!("{name}.forces.csv")), forces).unwrap();
}

/// A folder with presses of an original and of a copy that is 30 % less sensitive, and the calibration of the original.
fn calibrated(name: &str) -> PathBuf {
    let folder = folder(name);
    let layout = run(&folder, &["list", "--taxels", "eflesh"]).stdout;
    let columns = "columns = { x = \"{prefix}{n}_x\"";
    let timed = "columns = { time = { column = \"t\", unit = \"s\" }, x = \"{prefix}{n}_x\"";
    let layout = layout.replace(columns, timed);
    let layout = layout.lines().map(|line| match line.starts_with("zero =") {
        true => "zero = { rows = 1 }\n".to_owned(),
        false => format!("{line}\n"),
    });
    fs::write(folder.join("skin.toml"), layout.collect::<String>()).unwrap();
    press(&folder, "original", 30, 1.0);
    press(&folder, "again", 5, 1.0);
    press(&folder, "copy", 10, 0.7);
    let options = ["--conditions", "22 °C", "-o", "wrench.toml"];
    let ended = calibrate(&folder, "original.forces.csv", &options);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    folder
}

fn calibrate(folder: &Path, forces: &str, options: &[&str]) -> Ended {
    let command = ["calibrate", forces, "--wrench", "--taxels", "skin.toml"];
    run(folder, &[&command[..], options].concat())
}

fn verify(folder: &Path, calibration: &str, forces: &str, options: &[&str]) -> Ended {
    let command = ["verify", calibration, forces, "--taxels", "skin.toml"];
    run(folder, &[&command[..], options].concat())
}

fn sense(folder: &Path, calibration: &str, options: &[&str]) -> Ended {
    let command = [
        "sense",
        "again.csv",
        "--taxels",
        "skin.toml",
        "--calibration",
        calibration,
    ];
    run(folder, &[&command[..], options].concat())
}

#[test]
fn an_unchanged_sensor_is_valid_and_another_copy_is_not() {
    let folder = calibrated("verify");
    let ended = verify(
        &folder,
        "wrench.toml",
        "again.forces.csv",
        &["-o", "verified.toml"],
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(ended.stdout.contains("still valid"), "{}", ended.stdout);
    let ended = sense(&folder, "verified.toml", &["--verified-within", "1"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let ended = sense(&folder, "wrench.toml", &["--verified-within", "1"]);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(ended.stderr.contains("never verified"), "{}", ended.stderr);
    let ended = verify(
        &folder,
        "wrench.toml",
        "copy.forces.csv",
        &["--json", "-o", "failed.toml"],
    );
    assert_eq!(ended.status, Some(1), "{ended:?}");
    let result: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!(result["valid"], false);
    // The copy measures 0.7 of the force.
    let gain = result["axes"][0]["gain_drift"].as_f64().unwrap();
    assert!((gain - (1.0 / 0.7 - 1.0)).abs() < 0.02, "{gain}");
    let ended = sense(&folder, "failed.toml", &["--verified-within", "1"]);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(ended.stderr.contains("no longer valid"), "{}", ended.stderr);
}

#[test]
fn a_calibration_is_transferred_to_a_copy() {
    let folder = calibrated("transfer");
    let transferred = ["--from", "wrench.toml", "-o", "copy.toml"];
    let ended = calibrate(&folder, "copy.forces.csv", &transferred);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let ended = verify(&folder, "copy.toml", "copy.forces.csv", &[]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let ended = verify(&folder, "copy.toml", "again.forces.csv", &[]);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    let text = fs::read_to_string(folder.join("copy.toml")).unwrap();
    assert!(text.contains("transferred_from = "), "{text}");
}

#[test]
fn edited_calibrations_and_unsuitable_presses_are_refused() {
    let folder = calibrated("verify-refused");
    let text = fs::read_to_string(folder.join("wrench.toml")).unwrap();
    fs::write(folder.join("edited.toml"), text.replace("22 °C", "25 °C")).unwrap();
    press(&folder, "two", 2, 1.0);
    fs::write(
        folder.join("torque.csv"),
        "recording,time,m_z\nagain.csv,1,1\nagain.csv,2,0\n",
    )
    .unwrap();
    fs::write(folder.join("element.toml"), "kind = \"calibration\"\n").unwrap();
    for (calibration, forces, options, words) in [
        (
            "edited.toml",
            "again.forces.csv",
            vec![],
            "changed after it was written",
        ),
        (
            "wrench.toml",
            "two.forces.csv",
            vec![],
            "expected at least 3 presses",
        ),
        (
            "wrench.toml",
            "torque.csv",
            vec![],
            "band of errors; got none",
        ),
        (
            "element.toml",
            "again.forces.csv",
            vec![],
            "feeler calibrate --wrench",
        ),
        (
            "wrench.toml",
            "again.forces.csv",
            vec!["-o", "again.csv"],
            "again.csv",
        ),
        (
            "wrench.toml",
            "again.forces.csv",
            vec!["-o", "wrench.toml", "--force"],
            "wrench.toml",
        ),
        (
            "wrench.toml",
            "again.forces.csv",
            vec!["--false-alarm-rate", "0.5"],
            "0.1",
        ),
    ] {
        let ended = verify(&folder, calibration, forces, &options);
        assert_eq!(ended.status, Some(2), "{calibration} {forces}: {ended:?}");
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
    let transferred = ["--from", "wrench.toml", "-o", "x.toml"];
    let ended = calibrate(&folder, "two.forces.csv", &transferred);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(
        ended.stderr.contains("expected at least 3 presses"),
        "{}",
        ended.stderr
    );
}
