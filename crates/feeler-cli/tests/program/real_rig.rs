//! An experiment file without `[sim]`, which describes a real rig.

use crate::program::{experiment, folder, run};
use std::fs;

/// Writes the reference experiment without its simulated world to a folder for the test called `name`.
fn real_rig(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    experiment(&folder, "name = ", "name = ");
    let file = folder.join("my.toml");
    let text = fs::read_to_string(&file).unwrap();
    let kept = text.split("\n[sim").next().unwrap();
    fs::write(file, kept).unwrap();
    folder
}

#[test]
fn real_rig_is_checked_and_refused_by_simulating_commands() {
    let folder = real_rig("real-rig");
    let good = run(&folder, &["check", "my.toml"]).done();
    assert!(
        good.contains("2 fingers of 41 elements") && good.contains("real rig"),
        "{good}"
    );
    for command in [
        &["run", "my.toml"][..],
        &[
            "sweep",
            "my.toml",
            "--vary=control.over_force=uniform(0.4,0.6)",
            "-o=s",
        ],
        &["compare", "my.toml", "-o=c"],
        &[
            "calibrate",
            "--simulated",
            "--experiment=my.toml",
            "-o=c.toml",
        ],
    ] {
        run(&folder, command).refused(&["cap-closing", "no [sim]", "feeler hand"]);
    }
}

#[test]
fn real_rig_requires_a_matching_calibration() {
    let folder = real_rig("real-rig-calibration");
    let other = "sensor.fingertip.layout.dome_radius=0.017";
    run(&folder, &["check", "my.toml", "--set", other]).refused(&["dome_radius"]);
    let home = "task.screw.finger.0.home=[0.3,0.0,0.1]";
    run(&folder, &["check", "my.toml", "--set", home]).refused(&["home", "cannot be reached"]);
}
