//! A `feeler_msgs/TactileArray`, read by an independent library from the definitions in `ros2/feeler_msgs`.

use super::python::read_by;
use crate::whole_runs::folder;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_record::tactile_array::{TactileArray, of_finger, set_recorded};
use feeler_record::wire::cdr;
use feeler_record::{Flags, Tactile};
use serde_json::{Value, json};
use std::fs;

/// A sample of the first finger of the reference experiment.
fn sample() -> TactileArray {
    let settings = ["sensing=\"direct\"".to_string()];
    let experiment = Experiment::load("cap-closing", &settings).expect("an experiment");
    let session = Session::new(&experiment).expect("a session");
    let mut array = of_finger(&session.facts(&experiment.config), 0).expect("a finger");
    let elements = array.elements();
    let number = |element: usize| 0.01 * element as f64;
    let force = |element| [number(element), -0.5, number(element) - 0.1];
    let forces = (0..elements).map(|element| match element {
        3 => [f64::NAN; 3],
        _ => force(element),
    });
    let tactile = Tactile {
        sequence: 12,
        stamp: 3.5,
        forces: forces
            .map(|force| glam::DVec3::from_array(force).into())
            .collect(),
    };
    let flags = Flags {
        shear_rate: (0..elements)
            .map(|element| 30.0 * number(element))
            .collect(),
        ..Flags::default()
    };
    set_recorded(&mut array, &tactile, &flags);
    array
}

#[test]
fn rosbags_reads_the_message_from_its_definition() {
    let array = sample();
    let mut bytes = Vec::new();
    cdr::encode(&array, &mut bytes).expect("an encoded message");
    println!("{} elements, {} bytes", array.elements(), bytes.len());
    let path = folder("tactile-array").join("message.cdr");
    fs::write(&path, &bytes).expect("a file");
    let Some(found) = read_by("read_tactile_array.py", &["rosbags"], &path) else {
        return;
    };
    // NaN becomes null in both.
    let own = serde_json::to_value(&array).expect("JSON");
    let message = &found["message"];
    for field in [
        "sequence",
        "sensor",
        "principle",
        "simulated",
        "rate",
        "positions",
        "orientations",
        "areas",
    ] {
        assert_eq!(message[field], own[field], "{field}");
    }
    for field in [
        "contact",
        "contact_threshold",
        "slip_threshold",
        "overload_threshold",
        "channels",
    ] {
        assert_eq!(message[field], own[field], "{field}");
    }
    assert_eq!(message["header"]["frame_id"], "finger_0_dome");
    assert_eq!(
        message["header"]["stamp"],
        json!({"sec": 3, "nanosec": 500_000_000})
    );
    let force = &message["channels"][0];
    assert_eq!(
        (&force["name"], &force["unit"]),
        (&json!("force"), &json!("N"))
    );
    assert_eq!(force["values"][9], Value::Null);
    assert_eq!(force["status"][3], 1);
    // Pressed with 0.1 N: along -z of the element.
    assert_eq!(force["values"][3 * 20 + 2], json!(-(0.01 * 20.0 - 0.1)));
    // The definitions describe the bytes completely.
    let again: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(found["again"], again);
}
