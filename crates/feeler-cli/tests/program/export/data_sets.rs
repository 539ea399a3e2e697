//! `feeler export lerobot`

use super::made_up::{BAR, MadeUp, bar, recording_file};
use super::python::read_by;
use super::short_run;
use crate::program::{folder, run};
use feeler_record::Recording;
use serde_json::{Value, json};

/// Tolerance of statistics of values up to 1000: rounding of sums of 32-bit numbers in 64-bit arithmetic.
const STATS_TOLERANCE: f64 = 1e-9;

#[test]
fn lerobot_reader_reads_the_recorded_data() {
    let folder = folder("export-data-set");
    short_run(&folder, "one", "1");
    short_run(&folder, "two", "2");
    let export = [
        "export",
        "lerobot",
        "one",
        "two",
        "-o",
        "set",
        "--task",
        "Close the bottle.",
    ];
    let said = run(&folder, &export).done();
    let recordings = ["one", "two"].map(|name| {
        let path = folder.join(name).join("recording.mcap");
        Recording::read(path).unwrap()
    });
    let [one, two] = recordings.each_ref().map(|recording| recording.task.len());
    assert_eq!(said, format!("set: 2 episodes, {} frames\n", one + two));
    let modules = ["av", "datasets", "numpy", "pandas"];
    let Some(found) = read_by("read_data_set.py", &modules, &folder.join("set")) else {
        return;
    };
    let info = &found["info"];
    assert_eq!(info["codebase_version"], "v3.0");
    assert_eq!(info["fps"], 100);
    assert_eq!(
        (&info["total_frames"], &found["frames"]),
        (&json!(one + two), &json!(one + two))
    );
    assert_eq!(info["video_path"], Value::Null);
    assert_eq!(found["tasks"], json!({ "Close the bottle.": 0 }));
    assert_eq!(found["last_task"], "Close the bottle.");
    let second = &found["episodes"][1];
    assert_eq!(second["tasks"], json!(["Close the bottle."]));
    assert_eq!(
        (&second["length"], &second["dataset_from_index"]),
        (&json!(two), &json!(one))
    );
    assert_eq!(second["dataset_to_index"], json!(one + two));
    assert_eq!(
        second["feeler/digest"],
        json!(recordings[1].digest.to_string())
    );
    assert!(found["stats_apart"].as_f64().unwrap() < STATS_TOLERANCE);
    let keys: Vec<_> = found["features"].as_object().unwrap().keys().collect();
    assert_eq!(found["stats_keys"], json!(keys));
    for (key, of_type) in found["types"].as_object().unwrap() {
        assert_eq!(of_type, &found["features"][key]["dtype"], "{key}");
    }
    values_are_those_on_record(&found["values"], &recordings);
}

fn values_are_those_on_record(values: &Value, recordings: &[Recording; 2]) {
    let joined = |of_step: &dyn Fn(&Recording, usize) -> Value| -> Value {
        let of_run = |run: &Recording| -> Vec<Value> {
            (0..run.task.len()).map(|step| of_step(run, step)).collect()
        };
        recordings.iter().flat_map(of_run).collect()
    };
    // As 32-bit numbers.
    let short = |number: f64| f64::from(number as f32);
    let expected = joined(&|_, step| json!(short(step as f64 / 100.0)));
    assert_eq!(values["timestamp"], expected);
    let expected = joined(&|recording, step| {
        let fingers = recording.fingers.iter();
        fingers
            .flat_map(|f| f.joints[step].position)
            .map(short)
            .collect()
    });
    assert_eq!(values["observation.state"], expected);
    let expected = joined(&|recording, step| {
        let fingers = recording.fingers.iter();
        fingers
            .flat_map(|f| f.command[step].joint_velocity)
            .map(short)
            .collect()
    });
    assert_eq!(values["action"], expected);
    let expected = joined(&|recording, step| {
        let forces = recording.fingers[1].tactile[step].forces.iter();
        forces
            .map(|f| json!([short(f.x), short(f.y), short(f.z)]))
            .collect()
    });
    assert_eq!(values["observation.tactile.finger_1.force"], expected);
    let expected = joined(&|recording, step| {
        let flags = &recording.fingers[0].flags[step];
        json!([flags.touch, flags.slip, flags.over])
    });
    assert_eq!(values["observation.tactile.finger_0.flags"], expected);
}

/// Width and height of the images (px).
const SIZE: (usize, usize) = (96, 64);

#[test]
fn lerobot_reader_reads_the_recorded_images() {
    let folder = folder("export-pictures");
    let steps = [23, 12];
    for (name, steps) in ["one.mcap", "two.mcap"].into_iter().zip(steps) {
        let made_up = MadeUp {
            fingers: 2,
            steps,
            pictures: Some(SIZE),
            ..MadeUp::default()
        };
        recording_file(&made_up, &folder.join(name));
    }
    let export = ["export", "lerobot", "one.mcap", "two.mcap", "-o", "set"];
    let said = run(&folder, &export).done();
    assert_eq!(said, "set: 2 episodes, 35 frames\n");
    let modules = ["av", "datasets", "numpy", "pandas"];
    let Some(found) = read_by("read_data_set.py", &modules, &folder.join("set")) else {
        return;
    };
    assert_eq!(found["colour"], 0, "images are not gray");
    let steps = steps.into_iter().flat_map(|steps| 0..steps);
    for (frame, step) in steps.enumerate() {
        for finger in 0..2 {
            let key = format!("observation.images.finger_{finger}");
            let columns = &found["columns"][key][frame];
            let columns: Vec<f64> = serde_json::from_value(columns.clone()).unwrap();
            let first = bar(step, finger, SIZE.0);
            for (column, grey) in columns.iter().enumerate() {
                let expected = if (first..first + BAR).contains(&column) {
                    255.0
                } else {
                    0.0
                };
                // The bar moves by half its width in each step, so that another image would differ by 255 gray levels.
                assert!(
                    (grey - expected).abs() < 64.0,
                    "{finger}, {step}, {column}: {grey}"
                );
            }
        }
    }
    let stats: Value =
        serde_json::from_slice(&std::fs::read(folder.join("set/meta/stats.json")).unwrap())
            .unwrap();
    let stats = &stats["observation.images.finger_1"];
    let share = BAR as f64 / SIZE.0 as f64;
    for colour in 0..3 {
        let mean = stats["mean"][colour][0][0].as_f64().unwrap();
        assert!((mean - share).abs() < 1e-12);
        let std = stats["std"][colour][0][0].as_f64().unwrap();
        assert!((std - (share * (1.0 - share)).sqrt()).abs() < 1e-12);
    }
    assert_eq!(stats["count"], json!([35]));
}
