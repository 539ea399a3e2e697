//! Any experiment is rejected or runs, without panic, hang or excessive memory.

use feeler::sensor::calibration::CalibrationTarget;
use feeler_lab::config::{Experiment, Sensing};
use feeler_lab::experiment::Session;
use proptest::prelude::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::path::{Path, PathBuf};
use toml_edit::{DocumentMut, Item, Value};

/// Rejects single allocations larger than any experiment requires, which aborts the test.
struct Bounded;

const MAX_AT_ONCE: usize = 256 << 20;

// SAFETY: requests are forwarded to the system's allocator or rejected with a null pointer.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() > MAX_AT_ONCE {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`; all memory came from the system.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

const STEPS: usize = 3;

/// One sensor fault of each kind.
const FAULTS: &str = "{from=0.0, until=1.0, kind.dead_element={finger=0, element=0}}, \
    {kind.stuck_rows={finger=0, first=100, count=20, gray=255}}, \
    {kind.frozen_frame={finger=1}}, \
    {kind.dropped_frames={finger=1, probability=0.5}}, \
    {kind.camera_latency={finger=0, delay=0.002}}, \
    {kind.servo_stall={finger=0, joint=1}}, \
    {kind.joint_freeze={finger=0, joint=0}}, \
    {kind.joint_gain={finger=1, joint=1, gain=0.5}}, \
    {kind.joint_jump={finger=1, joint=0, angle=0.1}}, \
    {kind.sensor_gain={finger=1, gain=2.0}}, \
    {kind.swapped_sensors={finger=0, other=1}}, \
    {kind.backlash={finger=1, joint=2, angle=0.01}}, \
    {kind.friction_drop={factor=0.1}}";

/// The reference experiment with faults and with images small enough to render a thousand times.
fn reference(sensing: &str) -> String {
    let text = include_str!("../experiments/cap-closing.toml");
    let settings = [
        format!("sensing={sensing}"),
        "sensor.fingertip.camera.width=160".into(),
        "sensor.fingertip.camera.height=120".into(),
        "sensor.fingertip.camera.focal_length_px=48.75".into(),
        "control.period=0.002".into(),
        format!("sim.fault=[{FAULTS}]"),
        "sim.feeler.relaxation={share=0.2, time=0.3}".into(),
        "sim.holder={lateral={stiffness=[4e4, 3e4], play=[1e-4, 0.0]}, turn_play=0.005}".into(),
    ];
    Experiment::parse(text, "reference", &settings, None)
        .expect("the reference experiment")
        .toml
}

/// Runs a few steps of the experiment in `text`, or returns its error.
///
/// A calibration is created for its fingertip, so that sensing by images always runs.
fn try_to_run(text: &str, folder: &Path) -> Result<(), String> {
    let folder_of_calibration = Some(folder.to_path_buf());
    let experiment = Experiment::parse(text, "text", &[], folder_of_calibration);
    let experiment = experiment.map_err(|e| e.to_string())?;
    if experiment.config.sensing == Sensing::Image {
        make_up_calibration(&experiment, folder);
    }
    let mut session = Session::new(&experiment).map_err(|e| e.to_string())?;
    for _ in 0..STEPS {
        session.step().map_err(|e| e.to_string())?;
    }
    Ok(())
}

fn make_up_calibration(experiment: &Experiment, folder: &Path) {
    let name = &experiment.config.sensor.calibration;
    if name != "reference-fingertip.coupled.calibration.toml" {
        return;
    }
    let built_in = Experiment::load("cap-closing", &[]).expect("the reference experiment");
    let mut calibration = built_in.calibration(0).expect("its own");
    let fingertip = &experiment.config.sensor.fingertip;
    calibration.made_for = CalibrationTarget::fingertip(fingertip).expect("its hash");
    let elements = fingertip.layout.element_count();
    let any = calibration.elements[0].clone();
    calibration.elements.resize(elements.min(1000), any);
    let text = calibration.to_toml().expect("its text");
    fs::write(folder.join(name), text).expect("its file");
}

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&path).expect("the test's folder");
    path
}

/// Path of a number in a document.
type Key = Vec<String>;

fn numbers(item: &Item, key: &mut Key, found: &mut Vec<Key>) {
    let mut children: Vec<(String, Item)> = Vec::new();
    if let Some(table) = item.as_table_like() {
        children.extend(table.iter().map(|(k, v)| (k.to_string(), v.clone())));
    } else if let Some(tables) = item.as_array_of_tables() {
        let tables = tables.iter().map(|t| Item::Table(t.clone()));
        children.extend(tables.enumerate().map(|(i, t)| (i.to_string(), t)));
    } else if let Some(array) = item.as_array() {
        let values = array.iter().map(|v| Item::Value(v.clone()));
        children.extend(values.enumerate().map(|(i, v)| (i.to_string(), v)));
    } else if item.is_float() || item.is_integer() {
        found.push(key.clone());
    }
    for (name, child) in children {
        key.push(name);
        numbers(&child, key, found);
        key.pop();
    }
}

/// Text of `document` with the number at `key` replaced.
fn replaced(document: &DocumentMut, key: &Key, value: &Value) -> String {
    let mut document = document.clone();
    let mut item = document.as_item_mut();
    for part in key {
        item = match part.parse::<usize>() {
            Ok(index) => &mut item[index],
            Err(_) => &mut item[part.as_str()],
        };
    }
    *item = Item::Value(value.clone());
    document.to_string()
}

/// Replaces each number of the experiment by each extreme value, with and without images.
#[test]
fn an_experiment_with_any_number_replaced_is_rejected_or_runs() {
    let bad = [
        "-1", "-1.0", "0", "0.0", "nan", "inf", "-inf", "1e300", "1e-300",
    ];
    let worse = ["\"word\"", "9223372036854775807", "9.2e18", "true", "[]"];
    let values: Vec<Value> = bad
        .iter()
        .chain(&worse)
        .map(|text| text.parse().expect("a value"))
        .collect();
    let folder = folder("any-number");
    let (mut ran, mut refused) = (0, 0);
    for sensing in ["direct", "image"] {
        let text = reference(sensing);
        assert_eq!(try_to_run(&text, &folder), Ok(()));
        let document: DocumentMut = text.parse().expect("the experiment");
        let mut keys = Vec::new();
        numbers(document.as_item(), &mut Key::new(), &mut keys);
        assert!(keys.len() > 100, "{} numbers", keys.len());
        let about_pictures =
            |key: &&Key| key[0] == "sensor" || key.starts_with(&["sim".into(), "optics".into()]);
        for key in keys
            .iter()
            .filter(|k| sensing == "direct" || about_pictures(k))
        {
            for value in &values {
                let outcome = try_to_run(&replaced(&document, key, value), &folder);
                *(if outcome.is_ok() {
                    &mut ran
                } else {
                    &mut refused
                }) += 1;
                let what = format!("{} = {value}", key.join("."));
                let is_number = value.is_float() || value.is_integer();
                let finite = value.as_float().is_none_or(f64::is_finite);
                assert!(outcome.is_err() || (is_number && finite), "{what} runs");
            }
        }
    }
    println!("{ran} ran, {refused} were rejected");
    assert!(ran > 100 && refused > 1000, "{ran} ran, {refused} rejected");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    /// Replaces, inserts or deletes bytes anywhere.
    #[test]
    fn a_damaged_experiment_is_rejected_or_runs(
        edits in prop::collection::vec((0.0..1.0f64, 0..3u8, any::<u8>(), any::<bool>()), 1..4),
        with_pictures in prop::bool::weighted(0.1),
    ) {
        let text = reference(if with_pictures { "image" } else { "direct" });
        let mut bytes = text.into_bytes();
        for (place, kind, byte, digit) in edits {
            let place = (place * bytes.len() as f64) as usize;
            let byte = if digit { b"0123456789-.e"[usize::from(byte) % 13] } else { byte };
            match kind {
                0 => bytes[place] = byte,
                1 => bytes.insert(place, byte),
                _ => drop(bytes.remove(place)),
            }
        }
        let _ = try_to_run(&String::from_utf8_lossy(&bytes), &folder("damaged"));
    }

    /// Replaces digits of numbers, which more often gives a valid experiment.
    #[test]
    fn an_experiment_with_other_digits_is_rejected_or_runs(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..13usize), 1..6),
    ) {
        let mut bytes = reference("direct").into_bytes();
        let digits: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        for (place, digit) in edits {
            bytes[*place.get(&digits)] = b"0123456789-.e"[digit];
        }
        let _ = try_to_run(&String::from_utf8_lossy(&bytes), &folder("digits"));
    }
}
