//! ROS 2 tools and Rerun read a run as feeler recorded it.
//!
//! Needs `pip install mcap mcap-ros2-support rosbags rerun-sdk` in the Python named by `FEELER_PYTHON` (default
//! `python3`). Without them the test is reported as skipped, or fails if `FEELER_REQUIRE_ALL` is set.

use super::python::read_by;
use crate::whole_runs::{folder, run};
use feeler_lab::experiment::Pictures;
use feeler_record::{Recording, Stamped, Tactile};
use feeler_report::run::make::RECORDING;
use glam::{DMat4, DQuat, DVec3};
use serde_json::{Value, json};

/// Time until the cap is grasped and turns (s).
const SECONDS: f64 = 3.0;
/// Tolerance of poses, in m and of components of rotations: 64-bit numbers from the same angles.
const POSE_TOLERANCE: f64 = 1e-9;
/// Tolerance of a force (N) below 2 N on one element: relative precision 2^-24 of 32-bit numbers; and of the sum of 41.
const ELEMENT_TOLERANCE: f64 = 1.2e-7;
const FORCE_TOLERANCE: f64 = 41.0 * ELEMENT_TOLERANCE;
/// Tolerance of their torque about the dome's centre (N m): the tips' positions, 0.018 m away, are 32-bit numbers, too.
const TORQUE_TOLERANCE: f64 = 2.0 * 0.018 * FORCE_TOLERANCE;

#[test]
fn viewers_find_what_feeler_recorded() {
    let folder = folder("for-viewers");
    let settings = ["sensing=direct".into(), format!("time_limit={SECONDS}")];
    run(&settings, Pictures::Sensed, &folder);
    let path = folder.join(RECORDING);
    let modules = ["mcap", "mcap_ros2", "rosbags", "rerun"];
    let Some(found) = read_by("read_by_viewers.py", &modules, &path) else {
        return;
    };
    let recording = Recording::read(&path).unwrap();
    everything_is_decoded(&found);
    poses_are_those_on_record(&found["poses"], &recording);
    joints_are_those_on_record(&found["rosbags"]["last"]["/joint_states"], &recording);
    for finger in 0..recording.fingers.len() {
        forces_are_those_on_record(&found["felt"][finger], &recording, finger);
    }
    rerun_shows_the_hand(&found["rerun"], &recording);
}

fn everything_is_decoded(found: &Value) {
    assert!(found["written"].as_object().unwrap().len() > 20);
    assert_eq!(found["rosbags"]["counts"], found["written"]);
    assert_eq!(found["mcap_ros2"]["counts"], found["written"]);
    assert_eq!(found["rosbags"]["last"], found["mcap_ros2"]["last"]);
    let standard = [
        "geometry_msgs/msg/WrenchStamped",
        "sensor_msgs/msg/JointState",
        "sensor_msgs/msg/PointCloud2",
        "std_msgs/msg/String",
        "tf2_msgs/msg/TFMessage",
        "visualization_msgs/msg/MarkerArray",
    ];
    assert_eq!(found["rosbags"]["standard_types"], json!(standard));
    assert_eq!(found["rosbags"]["differing_types"], json!([]));
}

fn poses_are_those_on_record(found: &Value, recording: &Recording) {
    let links = found["links"].as_array().unwrap();
    for frame in found["frames"].as_array().unwrap() {
        assert!(links.contains(frame), "{frame} is not a link");
    }
    assert!(number(&found["from_description_apart"]) < POSE_TOLERANCE);
    let all = found["of_frames"].as_array().unwrap();
    assert!(all.len() as f64 >= 25.0 * SECONDS, "{} messages", all.len());
    for moment in all {
        let time = number(&moment["time"]) * 1e-9;
        let compare = |frame: &str, rotation: DQuat, position: DVec3| {
            let columns: [f64; 16] =
                serde_json::from_value(moment["poses"][frame].clone()).unwrap();
            let expected = DMat4::from_rotation_translation(rotation, position);
            let pose = DMat4::from_cols_array(&columns);
            assert!(
                pose.abs_diff_eq(expected, POSE_TOLERANCE),
                "{frame} at {time} s: expected {expected}, got {pose}"
            );
        };
        for (finger, record) in recording.fingers.iter().enumerate() {
            let tip = at(&record.fingertip, time);
            let frame = format!("finger_{finger}_dome");
            compare(&frame, tip.orientation.into(), tip.position.into());
        }
        let cap = at(&recording.cap, time);
        compare("cap", DQuat::from_rotation_z(cap.angle), cap.centre.into());
    }
}

fn joints_are_those_on_record(found: &Value, recording: &Recording) {
    let last = recording.fingers.iter().map(|f| f.joints.last().unwrap());
    let positions: Vec<_> = last.clone().flat_map(|j| j.position).collect();
    let velocities: Vec<_> = last.flat_map(|j| j.velocity).collect();
    assert_eq!(found["position"], json!(positions));
    assert_eq!(found["velocity"], json!(velocities));
    assert_eq!(found["name"][3], "finger_1_joint_1");
}

fn forces_are_those_on_record(found: &Value, recording: &Recording, finger: usize) {
    assert!(number(&found["largest_force"]) > 0.5, "expected a grasp");
    assert!(number(&found["force_apart"]) < FORCE_TOLERANCE);
    assert!(number(&found["torque_apart"]) < TORQUE_TOLERANCE);
    let points = &found["last_points"];
    let fields = points.as_object().unwrap().keys();
    let expected = ["x", "y", "z", "fx", "fy", "fz", "slip", "valid"];
    assert!(fields.len() == expected.len() && expected.iter().all(|f| points[f].is_array()));
    let time = number(&found["last_time"]) * 1e-9;
    let frame: &Tactile = at(&recording.fingers[finger].tactile, time);
    assert_eq!(points["valid"], json!(vec![1; frame.forces.len()]));
    for (element, own) in frame.forces.iter().enumerate() {
        let vector = |names: [&str; 3]| DVec3::from(names.map(|n| number(&points[n][element])));
        let (tip, force) = (vector(["x", "y", "z"]), vector(["fx", "fy", "fz"]));
        let expected = recording.facts.hand[finger].element_tips[element];
        assert!(tip.abs_diff_eq(expected.into(), 0.018 * ELEMENT_TOLERANCE));
        // The force presses against the normal; its tangential part is in the element's axes.
        let compression = -force.dot(tip.normalize());
        assert!((compression - own.z).abs() < ELEMENT_TOLERANCE, "{element}");
        let tangential = force.reject_from(tip.normalize()).length();
        assert!((tangential - own.x.hypot(own.y)).abs() < ELEMENT_TOLERANCE);
    }
}

fn rerun_shows_the_hand(found: &Value, recording: &Recording) {
    let near = |value: &Value, expected: f64| {
        let found = number(value);
        assert!((found - expected).abs() < 1e-8, "{found}, not {expected}");
    };
    for (finger, model) in recording.facts.hand.iter().enumerate() {
        for (link, length) in model
            .geometry
            .three_joints()
            .unwrap()
            .links
            .iter()
            .enumerate()
        {
            let frame = format!("finger_{finger}_link_{}", link + 1);
            near(&found["shapes"][&frame]["Cylinders3D:lengths"], *length);
            assert!(number(&found["turns"][frame]) > 0.001);
        }
        let dome = &found["shapes"][format!("finger_{finger}_dome")];
        near(&dome["Ellipsoids3D:half_sizes"][0], model.dome_radius);
        let points = &found["points"][format!("/finger/{finger}/taxels")];
        assert_eq!(points, &json!([model.element_tips.len()]));
        let arrows = &found["arrows"][finger.to_string()];
        assert!(number(&arrows["count"]) > 10.0);
        // Ends (m) of arrows of at most 0.02 m, as 32-bit numbers.
        assert!(number(&arrows["from_scene_apart"]) < 1e-8);
    }
    let cap = &found["shapes"]["cap"];
    near(&cap["Cylinders3D:radii"], recording.facts.cap_radius);
    assert!(number(&found["turns"]["cap"]) > 0.01);
}

/// Message of this time (s).
fn at<M: Stamped>(messages: &[M], time: f64) -> &M {
    let there = |message: &&M| (message.stamp() - time).abs() < 1e-6;
    messages.iter().find(there).expect("a message of this time")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}
