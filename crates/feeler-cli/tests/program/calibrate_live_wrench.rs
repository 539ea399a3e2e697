//! `feeler calibrate FOLDER --live --wrench` with an emulated force sensor: a simulated person loads the whole
//! fingertip.

use crate::calibrate_live::{FRAME, LAYOUT, drawn, program};
use crate::program::{Ended, feeler, folder, run};
use feeler::sensor::wrench::{WrenchAxis, WrenchCalibration};
use feeler_sources::NetFtEmulator;
use glam::{DVec2, DVec3};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{sleep, spawn};

/// Number of images for which each load is held.
const HELD: usize = 10;
/// Lever arm of the force about the sensor's origin (m).
const ARM: DVec3 = DVec3::new(0.0, 0.0, 0.02);

/// Forces on the fingertip for each image (N, z outward): a press and a pause.
fn press() -> impl Iterator<Item = DVec3> {
    let press = (0..60).map(|k| 0.7 * (std::f64::consts::PI * f64::from(k) / 60.0).sin().powi(2));
    let still = std::iter::repeat_n(0.0, 15);
    press
        .chain(still)
        .map(|normal| DVec3::new(0.0, 0.0, -normal))
}

/// Compressions in steps and pushes in all directions, each held; slightly different for each `number`.
fn loads(number: u32) -> impl Iterator<Item = DVec3> {
    let wander = 0.08 * f64::from(number).sin();
    let presses =
        (0..5).map(move |step| DVec3::new(0.0, 0.0, -0.1 - 0.2 * f64::from(step) + wander));
    let ways = [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y];
    let pushes = ways.into_iter().flat_map(move |way| {
        [0.28, 0.5].map(|shear| ((shear + 0.5 * wander) * way).extend(-0.5 - 2.0 * wander))
    });
    let free = std::iter::once(DVec3::ZERO);
    let all = presses.chain(pushes).chain(free);
    all.flat_map(|load| std::iter::repeat_n(load, HELD))
}

/// Slow presses at different forces, each held and followed by a pause.
fn presses() -> impl Iterator<Item = DVec3> {
    let presses = [0.5, 0.7, 0.6, 0.8, 0.55]
        .into_iter()
        .flat_map(|normal: f64| {
            let ramp = (0..30).map(move |k| normal * f64::from(k) / 30.0);
            let held = std::iter::repeat_n(normal, 30);
            ramp.clone().chain(held).chain(ramp.rev()).chain([0.0; 20])
        });
    presses.map(|normal| DVec3::new(0.0, 0.0, -normal))
}

/// Renders two spots that brighten by different amounts under compression, and move with shear. The fingertip responds
/// `gain` times as much to compression as the calibrated one.
fn picture(force: DVec3, gain: f64, number: usize) -> Vec<u8> {
    let spots = [(DVec2::new(16.0, 20.0), 0.6), (DVec2::new(48.0, 20.0), 0.4)];
    drawn(number, |place| {
        let spots = spots.iter().map(|&(centre, growth)| {
            let off = place - centre - 2.0 * force.truncate();
            110.0 * (1.0 - gain * growth * force.z) * (-off.length_squared() / 18.0).exp()
        });
        spots.sum()
    })
}

/// Calibrates with simulated data, with `times` repetitions of all loads, or until the program ends.
fn calibrate(folder: &Path, times: u32) -> Ended {
    let start = |address: &str| program(folder, address, &["--wrench"]);
    play(start, 1.0, (0..times).flat_map(loads))
}

/// Verifies again.toml with five presses of a fingertip that responds `gain` times as much. The images are saved in the
/// folder `name`.
fn verify(folder: &Path, name: &str, gain: f64) -> Ended {
    let start = |address: &str| {
        let output = format!("-o={name}.toml");
        let arguments = [
            "verify",
            "again.toml",
            name,
            "--live=-",
            "--rate=50",
            "--layout=layout.toml",
            "--force-sensor",
            address,
            "--force-axes=y,x,-z",
            &output,
        ];
        let mut command = feeler(folder, &arguments);
        let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped());
        streams.stderr(Stdio::piped()).spawn().expect("the program")
    };
    play(start, gain, presses())
}

/// Runs a program on simulated data: a pause, presses until the camera latency is known, and `forces`, or until the
/// program ends.
fn play(
    start: impl FnOnce(&str) -> Child,
    gain: f64,
    forces: impl Iterator<Item = DVec3> + Send + 'static,
) -> Ended {
    let now = Arc::new(Mutex::new(DVec3::ZERO));
    let felt = Arc::clone(&now);
    let sensor = NetFtEmulator::start(500.0, move || {
        let force = *felt.lock().unwrap();
        // Includes the fingertip's weight. The z axes of fingertip and sensor are opposite; x of one is y of the other.
        let to_sensor = |v: DVec3| [v.y, v.x, -v.z];
        let ([x, y, z], [a, b, c]) = (to_sensor(force), to_sensor(ARM.cross(force)));
        Some([x, y, z - 3.0, a, b, c])
    });
    let sensor = sensor.expect("a socket");
    let address = sensor.bare_address();
    let mut child = start(&address);
    let mut camera = child.stdin.take().expect("its input");
    let (knows, told) = (Arc::new(AtomicBool::new(false)), Arc::default());
    let stderr = BufReader::new(child.stderr.take().expect("its standard error"));
    let listener = spawn({
        let (knows, told) = (Arc::clone(&knows), Arc::<Mutex<String>>::clone(&told));
        move || {
            for line in stderr.lines().map_while(Result::ok) {
                knows.fetch_or(line.contains("camera latency"), Ordering::Relaxed);
                *told.lock().unwrap() += &(line + "\n");
            }
        }
    });
    let player = spawn(move || {
        let still = std::iter::repeat_n(DVec3::ZERO, 60);
        let pressed = move |_: &u32| !knows.load(Ordering::Relaxed);
        let presses = (0..100).take_while(pressed).flat_map(|_| press());
        let forces = still.chain(presses).chain(forces);
        for (number, force) in forces.enumerate() {
            *now.lock().unwrap() = force;
            // The program may have all data that it needs.
            if camera.write_all(&picture(force, gain, number)).is_err() {
                return;
            }
            sleep(FRAME);
        }
    });
    let mut ended = Ended::of(child.wait_with_output().expect("its end"));
    player.join().unwrap();
    listener.join().unwrap();
    ended.stderr = told.lock().unwrap().clone();
    ended
}

#[test]
fn live_loads_make_the_same_calibration_as_their_table() {
    let folder = folder("calibrate-live-wrench");
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    // The camera ends during the first rounds; the measured loads are kept.
    let ended = calibrate(&folder, 1);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    for words in [
        "the camera stream has ended",
        "of 5 rounds done",
        "bench/FORCES.csv --wrench",
    ] {
        assert!(ended.stderr.contains(words), "no {words:?} in {ended:?}");
    }
    let csv = folder.join("bench/FORCES.csv");
    let table = fs::read_to_string(&csv).unwrap();
    // At least the header and the untouched fingertip.
    assert!(table.lines().count() >= 17, "{table}");

    // The same command continues, and then ends: about ten repetitions of all loads are enough.
    let ended = calibrate(&folder, 100);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let resumed = fs::read_to_string(&csv).unwrap();
    assert!(
        resumed.starts_with(&table) && resumed.contains(",live_2,"),
        "{resumed}"
    );
    for words in [
        "camera latency",
        "round 5 of 5 done; held-out errors (RMSE): f_x",
    ] {
        assert!(ended.stderr.contains(words), "no {words:?} in {ended:?}");
    }

    // The result equals the calibration of the table.
    let again = [
        "calibrate",
        "bench/FORCES.csv",
        "--wrench",
        "--layout=layout.toml",
        "-o=again.toml",
    ];
    let again = run(&folder, &again);
    assert_eq!(again.status, Some(0), "{again:?}");
    let text = fs::read_to_string(folder.join("live.toml")).unwrap();
    assert_eq!(text, fs::read_to_string(folder.join("again.toml")).unwrap());
    assert!(folder.join("live.html").exists());
    let calibration = WrenchCalibration::from_toml(&text).unwrap();
    for axis in [WrenchAxis::ForceX, WrenchAxis::ForceY, WrenchAxis::ForceZ] {
        assert!(
            calibration.axis(axis).is_some(),
            "{axis:?} is not calibrated"
        );
    }
    // In every measured row, the torque is that of the force at its lever arm.
    let mut rows = csv::Reader::from_path(&csv).unwrap();
    let mut loaded = 0;
    for row in rows.records() {
        let row = row.unwrap();
        let values: Vec<f64> = (1..7).map(|k| row[k].parse().unwrap()).collect();
        let (force, torque) = (
            DVec3::from_slice(&values[..3]),
            DVec3::from_slice(&values[3..]),
        );
        let error = torque - ARM.cross(force);
        // The resolution of the sensor is 1e-6.
        assert!(error.length() < 1e-5, "{row:?}: {error}");
        loaded += usize::from(force.z < -0.05);
    }
    assert!(loaded > 200, "{loaded} rows");

    // Five presses on the same sensor verify it.
    let ended = verify(&folder, "same", 1.0);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(ended.stdout.contains("still valid"), "{ended:?}");
    assert!(ended.stderr.contains("0 more presses"), "{ended:?}");
    let verified = fs::read_to_string(folder.join("same.toml")).unwrap();
    let verified = WrenchCalibration::from_toml(&verified).unwrap();
    assert!(verified.passport.unwrap().verifications[0].valid);
    // A sensor that responds twice as much is rejected.
    let ended = verify(&folder, "softer", 2.0);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("no longer valid"), "{ended:?}");
    // Presses of an earlier session are not tested again.
    let arguments = [
        "verify",
        "again.toml",
        "same",
        "--live=-",
        "--layout=layout.toml",
    ];
    let sensor = "--force-sensor=netft://127.0.0.1:9?cpf=1&cpt=1";
    let refused = |more: &[&str], words: &[&str]| {
        run(&folder, &[&arguments, more].concat()).refused(words);
    };
    refused(&[sensor], &["same", "one with presses", "new folder"]);
    refused(&[sensor, "-o=same.toml"], &["same.toml", "exists already"]);
    refused(&[], &["--force-sensor"]);
    refused(
        &[sensor, "--force-axes=y,x,z"],
        &["--force-axes", "left-handed"],
    );
    refused(&[sensor, "--presses=2"], &["--presses"]);
    refused(
        &[sensor, "--exposure=0.01"],
        &["--exposure requires a camera"],
    );
}
