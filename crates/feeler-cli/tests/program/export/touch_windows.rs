//! `feeler export lerobot --touch-rate native`: tactile samples at the sensor's rate beside the frames of a video.
//!
//! The recordings are of a sensor at 437 Hz, with jitter and losses, and of a video at 30 frames per second. Forces and
//! images contain the time at which they were measured, with which the data set's times are compared.

use super::made_up::BAR;
use super::made_up::fast_touch::{ELEMENTS, FastTouch, IMAGES, Sample, TOUCH_RATE, bar};
use super::python::read_by;
use super::short_run;
use crate::program::{folder, run};
use feeler_record::Recording;
use serde_json::{Value, json};
use std::path::Path;

/// Frames per second of the video.
const FPS: u32 = 30;
const TACTILE: &str = "observation.tactile.finger_0";
/// Half the period of the sensor (s), the largest acceptable error of a time.
const HALF_PERIOD: f64 = 0.5 / TOUCH_RATE;

/// Exports the recordings of a folder and reads the data set as LeRobot does.
fn exported(folder: &Path, runs: &[&str]) -> Option<Value> {
    let fps = format!("--fps={FPS}");
    let export = [
        "export",
        "lerobot",
        "-o",
        "set",
        "--touch-rate",
        "native",
        &fps,
    ];
    let said = run(folder, &[&export, runs].concat()).done();
    assert!(said.contains(" frames with windows of "), "{said}");
    let modules = ["av", "datasets", "numpy", "pandas"];
    read_by("read_data_set.py", &modules, &folder.join("set"))
}

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone()).expect("numbers")
}

/// A sample in a window of the data set.
#[derive(Debug, Clone, Copy)]
struct Windowed {
    /// Number and true time (s) of the sample, from its forces.
    sample: Sample,
    /// Time by the data set (s).
    time: f64,
    is_new: bool,
}

/// Windows of all frames of an episode that begins at frame `from` and at the run time `start` (s).
fn windows(found: &Value, from: usize, length: usize, start: f64) -> Vec<Vec<Windowed>> {
    let values =
        |what: &str, frame: usize| &found["values"][format!("{TACTILE}.window.{what}")][frame];
    let window = |frame: usize| {
        let timestamp = found["values"]["timestamp"][frame]
            .as_f64()
            .expect("a time");
        let times = numbers(values("time", frame));
        let flags: Vec<bool> =
            serde_json::from_value(values("is_new", frame).clone()).expect("flags");
        let entries = times.into_iter().zip(flags).enumerate();
        let entry = |(place, (time, is_new)): (usize, (f64, bool))| {
            let force = numbers(&values("force", frame)[place][ELEMENTS - 1]);
            let (sequence, time) = (force[0] as u64, start + timestamp + time);
            let sample = Sample {
                sequence,
                time: force[2],
            };
            Windowed {
                sample,
                time,
                is_new,
            }
        };
        entries.map(entry).collect()
    };
    (from..from + length).map(window).collect()
}

/// Largest errors (s) of the times of samples and of the video's images.
fn worst_errors(found: &Value, windows: &[Vec<Windowed>], from: usize) -> (f64, f64) {
    let (mut touch, mut video) = (0.0_f64, 0.0_f64);
    for (frame, window) in windows.iter().enumerate() {
        for entry in window {
            touch = touch.max((entry.time - entry.sample.time).abs());
        }
        // The image shows the number of its sample; the latest sample has its time.
        let columns = numbers(&found["columns"]["observation.images.finger_0"][from + frame]);
        let brightness = |place: usize| columns[place..place + BAR].iter().sum::<f64>();
        let shown = (0..IMAGES)
            .max_by(|a, b| brightness(bar(*a as u64)).total_cmp(&brightness(bar(*b as u64))));
        let of_image =
            |entry: &&Windowed| entry.sample.sequence as usize % IMAGES == shown.expect("an image");
        let seen = window
            .iter()
            .rev()
            .find(of_image)
            .expect("the sample of the image");
        let latest = window.last().expect("a sample");
        video = video.max((latest.time - seen.sample.time).abs());
    }
    (touch, video)
}

fn start(found: &Value, episode: usize) -> f64 {
    let start = &found["episodes"][episode]["feeler/start_s"];
    start.as_f64().expect("a time")
}

#[test]
fn times_of_touch_and_video_agree_with_the_true_ones() {
    let folder = folder("export-windows");
    let runs = [false, true].map(|drops| FastTouch {
        steps: 180,
        shift: 0.0,
        drops,
    });
    runs[0].write(&folder.join("whole.mcap"));
    runs[1].write(&folder.join("lossy.mcap"));
    let Some(found) = exported(&folder, &["whole.mcap", "lossy.mcap"]) else {
        return;
    };
    assert_eq!(found["info"]["fps"], FPS);
    let force = &found["features"][format!("{TACTILE}.window.force")];
    // At most 15 periods of 437 Hz in one of 30 Hz, and one more by jitter and the choice of steps.
    let length = force["shape"][0].as_u64().expect("a length") as usize;
    assert!((15..=20).contains(&length), "{length}");
    assert_eq!(force["shape"], json!([length, ELEMENTS, 3]));
    assert!(found["stats_apart"].as_f64().expect("a number") < 1e-9);
    let mut from = 0;
    for (episode, run) in runs.iter().enumerate() {
        let frames = found["episodes"][episode]["length"]
            .as_u64()
            .expect("a length") as usize;
        let start = start(&found, episode);
        let windows = windows(&found, from, frames, start);
        let (touch, video) = worst_errors(&found, &windows, from);
        println!(
            "worst error of touch {touch:.1e} s, of video {video:.1e} s, of at most {HALF_PERIOD:.1e} s"
        );
        assert!(
            touch <= HALF_PERIOD && video <= HALF_PERIOD,
            "{touch} s, {video} s"
        );
        // Rounding to 32 bits is the only error: 0.1 µs of times up to 2 s, in forces and in timestamps.
        assert!(touch < 1e-6 && video < 1e-6, "{touch} s, {video} s");
        // Each recorded sample is new in exactly one frame, in order.
        let new = windows.iter().flatten().filter(|entry| entry.is_new);
        let new: Vec<u64> = new.map(|entry| entry.sample.sequence).collect();
        let first = *new.first().expect("a sample");
        let recorded = run.samples(start + (frames - 1) as f64 / f64::from(FPS) + 0.005);
        let recorded: Vec<u64> = recorded.iter().map(|sample| sample.sequence).collect();
        let whole = recorded.iter().skip_while(|number| **number < first);
        let whole: Vec<u64> = whole.copied().take(new.len()).collect();
        assert_eq!(new, whole);
        assert!(
            recorded.len() - new.len() < length,
            "{} of {}",
            new.len(),
            recorded.len()
        );
        // The latest sample is the one of the frame.
        for (frame, window) in windows.iter().enumerate() {
            let latest = numbers(&found["values"][format!("{TACTILE}.force")][from + frame][0]);
            let sample = window.last().expect("a sample").sample;
            assert_eq!(latest[0] as u64, sample.sequence, "{frame}");
        }
        from += frames;
    }
}

/// The comparison detects stamps that are wrong by one period of the sensor.
#[test]
fn a_shift_by_one_period_is_detected() {
    let folder = folder("export-shifted-windows");
    let shifted = FastTouch {
        steps: 60,
        shift: 1.0 / TOUCH_RATE,
        drops: false,
    };
    shifted.write(&folder.join("shifted.mcap"));
    let Some(found) = exported(&folder, &["shifted.mcap"]) else {
        return;
    };
    let frames = found["frames"].as_u64().expect("a number") as usize;
    let windows = windows(&found, 0, frames, start(&found, 0));
    let (touch, video) = worst_errors(&found, &windows, 0);
    assert!(
        touch > HALF_PERIOD && video > HALF_PERIOD,
        "{touch} s, {video} s"
    );
}

#[test]
fn windows_of_a_run_contain_every_tactile_frame() {
    let folder = folder("export-run-windows");
    short_run(&folder, "one", "1");
    let Some(found) = exported(&folder, &["one"]) else {
        return;
    };
    let recording = Recording::read(folder.join("one/recording.mcap")).expect("a recording");
    let force = &found["values"]["observation.tactile.finger_1.window.force"];
    let is_new = &found["values"]["observation.tactile.finger_1.window.is_new"];
    let forces = force
        .as_array()
        .expect("frames")
        .iter()
        .flat_map(|f| f.as_array().expect("samples"));
    let flags = is_new
        .as_array()
        .expect("frames")
        .iter()
        .flat_map(|f| f.as_array().expect("flags"));
    let new = forces
        .zip(flags)
        .filter(|(_, is_new)| **is_new == json!(true));
    let found: Vec<f64> = new
        .map(|(force, _)| force[7][2].as_f64().expect("a force"))
        .collect();
    let recorded = recording.fingers[1].tactile.iter();
    let recorded: Vec<f64> = recorded.map(|f| f64::from(f.forces[7].z as f32)).collect();
    // All up to the last frame.
    assert!(
        recorded.len() - found.len() < 4,
        "{} of {}",
        found.len(),
        recorded.len()
    );
    assert_eq!(found, recorded[..found.len()]);
}

#[test]
fn a_rate_above_the_control_rate_is_rejected() {
    let folder = folder("export-too-fast");
    short_run(&folder, "one", "1");
    let export = ["export", "lerobot", "one", "-o", "set", "--fps", "101"];
    run(&folder, &export).refused(&["one: rate", "1 to 100.000000 frames per second", "got 101"]);
}
