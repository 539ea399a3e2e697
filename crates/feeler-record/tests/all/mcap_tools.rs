//! The MCAP project's Python packages read recordings like feeler does.
//!
//! Needs `pip install mcap mcap-ros2-support` in the Python named by `FEELER_PYTHON` (default
//! `python3`). Without them the test is reported as skipped, or fails if
//! `FEELER_REQUIRE_ALL` is set.

use crate::python::read_by;
use crate::support;
use feeler::sensor::image::Frame;
use feeler_record::wire::Message;
use feeler_record::{Image, MessageSink, RecordOptions, Recorder, Recording, topics};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The recording at `path` as read by Python, or `None` if packages are missing.
fn read_by_python(path: &Path) -> Option<Value> {
    read_by("read_recording.py", &["mcap", "mcap_ros2"], path)
}

#[test]
fn python_reads_what_feeler_wrote() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("for-python.mcap");
    support::write_run(&path, 1).unwrap();
    if let Some(found) = read_by_python(&path) {
        compare(&found, &Recording::read(&path).unwrap());
    }
}

#[test]
fn python_reads_the_images() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pictures-for-python.mcap");
    let options = RecordOptions {
        calibrations: [("a.toml".to_string(), "b = 1".to_string())].into(),
        pictures: true,
        ..RecordOptions::default()
    };
    let mut recorder = Recorder::create_with(&path, &support::facts(), "", &options).unwrap();
    let mut frame = Frame::black(4, 3);
    frame.stamp = 1.25;
    frame.picture.pixels = (0..12).map(|i| 20 * i).collect();
    let mut taken = Image::of_finger(1);
    taken.fill(&frame).unwrap();
    recorder.write(topics::image(1), &taken).unwrap();
    recorder.finish(None).unwrap();
    let Some(found) = read_by_python(&path) else {
        return;
    };
    assert_eq!(found["attachments"]["calibration/a.toml"], "b = 1");
    let mut seen = found["last"]["/finger/1/image"].clone();
    let log_time = seen.as_object_mut().unwrap().remove("log_time").unwrap();
    assert_eq!(log_time, 1_250_000_000_u64);
    assert_eq!(seen["header"], json!(taken.header));
    assert_eq!(seen["format"], "png");
    let file: Vec<u8> = serde_json::from_value(seen["data"].take()).unwrap();
    let picture = image::load_from_memory(&file).unwrap();
    assert_eq!(picture.color(), image::ColorType::L8);
    assert_eq!((picture.width(), picture.height()), (4, 3));
    assert_eq!(picture.into_luma8().into_raw(), taken.data);
}

fn compare(found: &Value, recording: &Recording) {
    assert_eq!(found["profile"], "ros2");
    assert_eq!(
        found["attachments"]["experiment.toml"],
        recording.experiment
    );
    assert_eq!(
        found["metadata"]["feeler.run"]["seed"],
        u64::MAX.to_string()
    );
    assert_eq!(
        found["metadata"]["feeler.end"]["digest"],
        recording.digest.as_str()
    );
    let last = |topic: &str, message: Value| {
        let mut decoded = found["last"][topic].clone();
        let log_time = decoded.as_object_mut().unwrap().remove("log_time").unwrap();
        let stamp = message["stamp"].as_f64().unwrap();
        assert_eq!(log_time.as_f64().unwrap(), (stamp * 1e9).round(), "{topic}");
        assert_eq!(decoded, message, "{topic}");
        assert_eq!(found["counts"][topic], recording.task.len(), "{topic}");
    };
    for (f, finger) in recording.fingers.iter().enumerate() {
        last(&format!("/finger/{f}/tactile"), value(&finger.tactile));
        last(&format!("/finger/{f}/flags"), value(&finger.flags));
        last(&format!("/finger/{f}/joints"), value(&finger.joints));
        last(&format!("/finger/{f}/command"), value(&finger.command));
        last(&format!("/finger/{f}/fingertip"), value(&finger.fingertip));
    }
    last("/torque_sensor", value(&recording.torque_sensor));
    last("/cap", value(&recording.cap));
    last("/task", value(&recording.task));
}

/// The last message as JSON.
fn value<M: Message>(messages: &[M]) -> Value {
    messages
        .last()
        .map_or(Value::Null, |message| json!(message))
}
