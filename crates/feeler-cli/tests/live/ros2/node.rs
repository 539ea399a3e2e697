//! A replayed recording as a ROS 2 node, and invalid command lines.

use super::peers::{Running, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::{Ended, feeler, folder, run};
use std::path::Path;
use std::process::Stdio;

/// Asserts that the watcher receives the topics and services of a hand with two fingers.
pub fn assert_seen(words: &mut Words) {
    let tokens = words.next()["tokens"].clone();
    let tokens: Vec<&str> = tokens
        .as_array()
        .expect("tokens")
        .iter()
        .filter_map(|t| t.as_str())
        .collect();
    let count = |kind: &str| {
        tokens
            .iter()
            .filter(|t| t.contains(&format!("/{kind}/%/%/feeler")))
            .count()
    };
    assert_eq!(count("NN"), 1, "{tokens:?}");
    assert!(count("MP") >= 11 && count("SS") >= 6, "{tokens:?}");
    let joints = words.next();
    assert_eq!(joints["names"][5], "finger_1_joint_3");
    assert_eq!(joints["position"].as_array().map(Vec::len), Some(6));
    assert_eq!(
        (&joints["attachment"], &joints["is_publishers"]),
        (&33.into(), &true.into())
    );
    let felt = words.next();
    assert_eq!(
        (&felt["points"], &felt["bytes"]),
        (&41.into(), &(41 * 28).into())
    );
    assert_eq!(felt["frame"], "finger_1_dome");
    let description = words.next()["description"].to_string();
    assert!(description.contains("<robot name="), "{description}");
    let parameters = words.next()["parameters"].to_string();
    for name in ["control.law", "control.slip_threshold", "use_sim_time"] {
        assert!(parameters.contains(name), "{parameters}");
    }
}

/// Records one stroke in `folder`, then starts a node with `arguments` that replays it slowly.
pub fn replay(folder: &Path, arguments: &[&str]) -> Running {
    let stroke = "--set=task.screw.strokes=1";
    run(
        folder,
        &[
            "run",
            "cap-closing",
            "--sensing=direct",
            "--out=run",
            stroke,
        ],
    )
    .done();
    let of_run = ["ros2", "run", "--speed=0.05", "--domain-id=0"];
    let node = feeler(folder, &[&of_run, arguments].concat())
        .stdout(Stdio::null())
        .spawn();
    Running(node.expect("the node"))
}

#[test]
fn independent_peer_receives_a_replayed_recording() {
    let Some(python) = pyzeros() else { return };
    let (endpoint, router) = (unused_endpoint(), unused_endpoint());
    let places = ["--ros-listen", &endpoint, "--ros-connect", &router];
    let _node = replay(&folder("ros2-replay"), &places);
    let watcher = script(&python, "watch.py", &[&endpoint]).spawn();
    let mut watcher = Running(watcher.expect("the watcher"));
    assert_seen(&mut Words::of(&mut watcher));
    assert!(watcher.0.wait().expect("its end").success());
}

#[test]
fn invalid_command_lines_are_refused() {
    let folder = folder("ros2-refused");
    let refused = |arguments: &[&str], words: &[&str]| {
        let arguments = [&["ros2"], arguments].concat();
        Ended::of(feeler(&folder, &arguments).output().expect("it ran")).refused(words);
    };
    refused(
        &["cap-closing"],
        &["tcp/localhost:7447", "--listen tcp/127.0.0.1:7557"],
    );
    refused(
        &["cap-closing", "--domain-id", "233"],
        &["domain id", "233"],
    );
    refused(
        &["cap-closing", "--namespace", "a-b"],
        &["namespace", "a-b"],
    );
    refused(&["cap-closing", "--speed", "2"], &["--speed", "is a rig"]);
    refused(&["no.mcap", "--speed", "0"], &["--speed", "above 0"]);
    refused(&["no.mcap", "--rig", "x"], &["--rig", "is a recording"]);
    refused(&["no.mcap"], &["no.mcap"]);
}
