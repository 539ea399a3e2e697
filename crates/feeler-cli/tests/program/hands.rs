//! Hands of one to five fingers, each with a separate base, links and sensor.

use crate::program::{Ended, experiment, folder, run, summary};
use feeler_record::{FingerModel, FingerRecord, Recording};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// A fingertip with fewer elements and a smaller dome.
const SMALL: &str = "fingertip.layout = { dome_radius = 0.016, rings = [
  { elements = 1, polar_angle_deg = 0.0 },
  { elements = 8, polar_angle_deg = 22.5 },
  { elements = 12, polar_angle_deg = 45.0 },
] }
fingertip.camera = { width = 640, height = 480, focal_length_px = 195.0, standoff = 0.010 }
fingertip.moments = { dark_level = 24, subregion_radius = 0.0026 }
";

/// Number of elements of [`SMALL`].
const SMALL_ELEMENTS: usize = 21;

/// Writes `my.toml`: the reference experiment with `fingers` around the cap and the tables `sensors`.
fn hand(folder: &Path, fingers: usize, sensors: &str) {
    experiment(folder, "", "");
    let text = fs::read_to_string(folder.join("my.toml")).unwrap();
    let (head, rest) = text.split_once("# Two fingers that face").unwrap();
    let (_, control) = rest.split_once("[control]\n").unwrap();
    let (control, rest) = control.split_once("# The planned rectangle").unwrap();
    let (_, sim) = rest.split_once("[sim]\n").unwrap();
    let (mut bases, mut paths) = (String::new(), String::new());
    for finger in 0..fingers {
        // Direction in which the finger points, relative to the first finger.
        let angle = TAU * finger as f64 / fingers as f64;
        let turned = |x: f64, y: f64| {
            let (sin, cos) = angle.sin_cos();
            (x * cos - y * sin, x * sin + y * cos)
        };
        let ((x, y), middle) = (turned(-0.1655, 0.0), angle.to_degrees());
        write!(
            bases,
            "[[hand.finger]]\nbase_position = [{x}, {y}, 0.0576]\nphi1_deg = 0.0\nphi2_deg = 0.0\n\
             links = [0.030, 0.060, 0.055]\njoint_lower_deg = [{:?}, -30.0, -150.0]\n\
             joint_upper_deg = [{:?}, 120.0, 0.0]\njoint_speed_limit = [2.0, 2.0, 2.0]\n\n",
            middle - 60.0,
            middle + 60.0,
        )
        .unwrap();
        let ((x, y), approach, stroke) =
            (turned(-0.038, -0.001), turned(1.0, 0.0), turned(0.0, -1.0));
        writeln!(
            paths,
            "[[task.screw.finger]]\nhome = [{x}, {y}, 0.1]\napproach = [{}, {}, 0.0]\nstroke = [{}, {}, 0.0]",
            approach.0, approach.1, stroke.0, stroke.1,
        )
        .unwrap();
    }
    let control = control.replace("[-0.06, -0.03,", "[-0.06, -0.06,");
    let control = control.replace("[0.06, 0.03,", "[0.06, 0.06,");
    let text = format!("{head}{sensors}{bases}[control]\n{control}{paths}[sim]\n{sim}");
    fs::write(folder.join("my.toml"), text).unwrap();
}

/// Number of recorded elements of each finger in the run called `name`.
fn elements(folder: &Path, name: &str) -> Vec<usize> {
    let recording = Recording::read(folder.join(name).join("recording.mcap")).unwrap();
    let models = recording.facts.hand.iter();
    let of_finger = |(finger, model): (&FingerRecord, &FingerModel)| {
        let counts = finger.tactile.iter().map(|t| t.forces.len());
        let count = counts.clone().next().unwrap();
        assert!(counts.clone().all(|c| c == count));
        assert_eq!(model.element_tips.len(), count);
        count
    };
    recording
        .fingers
        .iter()
        .zip(models)
        .map(of_finger)
        .collect()
}

fn turned(folder: &Path, name: &str) -> f64 {
    let summary = summary(&folder.join(name));
    let strokes = summary["strokes"].as_array().unwrap();
    strokes
        .iter()
        .map(|s| s["cap_turn"].as_f64().unwrap())
        .sum()
}

#[test]
fn three_fingered_hand_closes_the_cap() {
    let folder = folder("hands-built-in");
    assert!(
        run(&folder, &["check", "three-fingers"])
            .done()
            .contains("3 fingers of 41 elements")
    );
    run(
        &folder,
        &["run", "three-fingers", "--sensing=direct", "--out=direct"],
    )
    .done();
    // The cap has reached its seat, which is at 0.59 rad within 5 %.
    assert!(
        turned(&folder, "direct") > 0.62,
        "{} rad",
        turned(&folder, "direct")
    );
}

#[test]
fn hands_of_one_and_five_fingers_run() {
    for fingers in [1, 5] {
        let folder = folder(&format!("hands-of-{fingers}"));
        hand(&folder, fingers, "");
        let check = run(&folder, &["check", "my.toml"]).done();
        assert!(
            check.contains(&format!("{fingers} fingers of 41 elements")),
            "{check}"
        );
        run(
            &folder,
            &["run", "my.toml", "--sensing=direct", "--out=direct"],
        )
        .done();
        assert!(
            turned(&folder, "direct") > 0.3,
            "{} rad",
            turned(&folder, "direct")
        );
        let short = ["run", "my.toml", "--set=time_limit=1.6", "--out=image"];
        out_of_time(run(&folder, &short));
        assert_eq!(elements(&folder, "image"), vec![41; fingers]);
    }
}

fn out_of_time(ended: Ended) {
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("time limit"), "{ended:?}");
}

#[test]
fn fingers_can_have_different_sensors() {
    let folder = folder("hands-own-sensors");
    let own = format!(
        "[[sensor.finger]]\n\n[[sensor.finger]]\ncalibration = \"small.toml\"\n{SMALL}\n[[sensor.finger]]\n\n"
    );
    hand(&folder, 3, &own);
    let expected = [41, SMALL_ELEMENTS, 41];
    run(&folder, &["check", "my.toml"]).refused(&[
        "sensor.finger[1].calibration = \"small.toml\"",
        "feeler calibrate",
    ]);
    let calibrate = [
        "calibrate",
        "--simulated",
        "my.toml",
        "--model=separable",
        "--loads=60",
    ];
    run(
        &folder,
        &[&calibrate[..], &["--finger=3", "-o", "small.toml"]].concat(),
    )
    .refused(&["no finger 3", "0 to 2"]);
    run(
        &folder,
        &[&calibrate[..], &["--finger=1", "-o", "small.toml"]].concat(),
    )
    .done();
    let check = run(&folder, &["check", "my.toml"]).done();
    assert!(
        check.contains("3 fingers of 41, 21, 41 elements"),
        "{check}"
    );
    // With and without images: the smaller dome reaches the cap later, and still grasps.
    run(&folder, &["run", "my.toml", "--out=image"]).done();
    run(
        &folder,
        &["run", "my.toml", "--sensing=direct", "--out=direct"],
    )
    .done();
    for name in ["image", "direct"] {
        assert_eq!(elements(&folder, name), expected);
        assert!(turned(&folder, name) > 0.4, "{} rad", turned(&folder, name));
    }
    let sense = ["sense", "image", "--finger=1", "-o", "forces.csv"];
    assert_eq!(run(&folder, &sense).status, Some(0));
    let table = fs::read_to_string(folder.join("forces.csv")).unwrap();
    assert_eq!((table.lines().count() - 1) % SMALL_ELEMENTS, 0);
    // The calibration of another finger's fingertip is refused.
    let other = "--set=sensor.finger.1.calibration=reference-fingertip.coupled.calibration.toml";
    run(&folder, &["check", "my.toml", other]).refused(&["finger 1", "another fingertip"]);
}

#[test]
fn number_of_sensors_must_match_number_of_fingers() {
    let folder = folder("hands-too-few-sensors");
    hand(&folder, 3, "[[sensor.finger]]\n\n[[sensor.finger]]\n\n");
    run(&folder, &["check", "my.toml"])
        .refused(&["sensor.finger = 2 fingers", "as many as hand.finger (3)"]);
    let bad = SMALL.replace("elements = 8", "elements = 0");
    hand(&folder, 1, &format!("[[sensor.finger]]\n{bad}\n"));
    run(&folder, &["check", "my.toml"])
        .refused(&["sensor.finger[0].fingertip.layout.rings[1].elements = 0"]);
}
