//! Options of the node (clock, domain and names), and its parameters.

use super::peers::{Running, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::{feeler, folder, run};
use feeler_record::Recording;
use serde_json::{Value, json};
use std::process::Stdio;
use std::time::{SystemTime, UNIX_EPOCH};

/// Speed of the replay, slow enough that the watcher receives its middle part.
const SPEED: f64 = 0.2;

/// A recorded stamp in ns.
fn nanoseconds(stamp: f64) -> i64 {
    (stamp * 1e9).round() as i64
}

/// Received values with their arrival times (s since 1970).
fn said(words: &Value) -> Vec<(Value, f64)> {
    let all = words.as_array().expect("a list").iter();
    all.map(|pair| (pair[0].clone(), pair[1].as_f64().expect("a time")))
        .collect()
}

#[test]
fn replay_uses_recorded_stamps_and_the_given_domain_and_namespace() {
    let Some(python) = pyzeros() else { return };
    let folder = folder("ros2-options");
    let arguments = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--out=run",
        "--set=task.screw.strokes=2",
    ];
    run(&folder, &arguments).done();
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");

    let endpoint = unused_endpoint();
    let arguments = [
        "ros2",
        "run",
        "--use-sim-time",
        "--namespace=/lab",
        "--node-name=hand",
        "--domain-id=7",
        "--ros-listen",
        &endpoint,
        "--ros-connect",
        &unused_endpoint(),
        "--speed",
        &SPEED.to_string(),
    ];
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let since = since.expect("a time").as_secs_f64();
    let node = feeler(&folder, &arguments).stdout(Stdio::null()).spawn();
    let _node = Running(node.expect("the node"));
    let watcher = script(&python, "options.py", &[&endpoint]).spawn();
    let mut watcher = Running(watcher.expect("the watcher"));
    let mut words = Words::of(&mut watcher);

    let tokens = words.next()["tokens"].clone();
    for token in tokens.as_array().expect("tokens") {
        let token = token.as_str().expect("text");
        assert!(
            token.starts_with("@ros2_lv/7/") && token.contains("/%/%lab/hand"),
            "{token}"
        );
    }
    assert!(
        tokens.to_string().contains("/%lab%finger_0%wrench/"),
        "{tokens}"
    );
    let heard = words.next();
    assert_eq!(heard["elsewhere"], json!([]));

    // Each stamp is a recorded one, with the joints of that time.
    let recorded = |finger: usize, stamp: &Value| {
        let joints = recording.fingers[finger].joints.iter();
        let found = joints
            .clone()
            .find(|joints| json!(nanoseconds(joints.stamp)) == *stamp);
        found.map(|joints| joints.position.as_slice().to_vec())
    };
    let first = nanoseconds(recording.fingers[0].joints[0].stamp);
    let joints = said(&heard["joints"]);
    for (joint, came) in &joints {
        let both: Vec<f64> = (0..2)
            .flat_map(|finger| recorded(finger, &joint[0]).expect("a recorded stamp"))
            .collect();
        assert_eq!(joint[1], json!(both));
        // No message arrives before it is due.
        let due = (joint[0].as_i64().expect("ns") - first) as f64 * 1e-9 / SPEED;
        assert!(came - since >= due, "{came} {since} {due}");
    }
    let stamps = |words: &Value| -> Vec<i64> {
        let all = said(words).into_iter();
        all.map(|(stamp, _)| stamp.as_i64().expect("ns")).collect()
    };
    let clock = stamps(&heard["clock"]);
    assert!(
        clock
            .iter()
            .all(|stamp| recorded(0, &json!(stamp)).is_some())
    );
    assert!(clock.is_sorted(), "{clock:?}");
    let pictures = recording.fingers[0].tactile.iter();
    let pictures: Vec<_> = pictures.map(|frame| nanoseconds(frame.stamp)).collect();
    let wrenches = stamps(&heard["wrench"]);
    assert!(
        wrenches.iter().all(|stamp| pictures.contains(stamp)),
        "{wrenches:?}"
    );

    assert_parameters(&mut words);
    assert!(watcher.0.wait().expect("its end").success());
}

/// Asserts the responses of the parameter services.
fn assert_parameters(words: &mut Words) {
    let listed = words.next();
    let names = listed["names"].to_string();
    assert!(names.contains("\"control.slip_threshold\""), "{names}");
    assert!(
        !names.contains("task.") && !names.contains("control.limits."),
        "{names}"
    );
    let values = words.next()["values"].clone();
    // The type, followed by the fields for double, string, integer and bool.
    assert_eq!(values[0][0], 3, "{values}");
    assert!(values[0][1].as_f64() > Some(0.0), "{values}");
    assert_eq!(
        (&values[1][0], &values[1][2]),
        (&json!(4), &json!("tri-axial"))
    );
    assert_eq!((&values[2][0], &values[2][3]), (&json!(2), &json!(2)));
    assert_eq!((&values[3][0], &values[3][4]), (&json!(1), &json!(true)));
    assert_eq!(values[4][0], 0, "{values}");
    assert_eq!(words.next()["types"], json!([3, 4, 2, 1, 0]));

    let described = words.next()["descriptors"].clone();
    let slip = &described[0];
    assert_eq!(
        (&slip["type"], &slip["read_only"]),
        (&json!(3), &json!(true))
    );
    assert!(slip["description"].to_string().contains("N/s"), "{slip}");
    assert!(slip["constraints"].to_string().contains("--set"), "{slip}");
    assert_eq!(slip["floats"][0][0], 0.0, "{slip}");
    assert_eq!(described[2]["integers"][0][0], 1, "{described}");

    for result in words.next()["results"].as_array().expect("results") {
        assert_eq!(result[0], false, "{result}");
    }
    let together = words.next()["results"][0].clone();
    assert_eq!(together[0], false);
    assert!(together[1].to_string().contains("--set"), "{together}");
}
