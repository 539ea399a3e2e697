//! A running rig as a ROS 2 node whose services stop and resume the hand.

use super::node::assert_seen;
use super::peers::{self, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::feeler;
use crate::rig::{Rig, Running, Setup};

/// Starts `feeler ros2` for a rig; the node listens at `graph`.
pub fn node(rig: &Rig, name: &str, graph: &str) -> Running {
    let Setup {
        folder,
        experiment,
        endpoint,
        settings,
        ..
    } = &rig.setup;
    let mut command = feeler(
        folder,
        &["ros2", experiment, "--connect", endpoint, "--domain-id=0"],
    );
    command.args(["--ros-listen", graph, "--ros-connect", &unused_endpoint()]);
    command.args(settings);
    Running::start(folder, name, command)
}

#[test]
fn independent_peer_stops_and_resumes_the_hand() {
    let Some(python) = pyzeros() else { return };
    let rig = Setup::new("ros2-rig")
        .at("0.1")
        .with(&["time_limit=600"])
        .start();
    let mut hand = rig.setup.hand(&[]);
    let graph = unused_endpoint();
    let _node = node(&rig, "ros2", &graph);
    let watcher = script(
        &python,
        "watch.py",
        &[&graph, "/stop", "/resume", "/resume"],
    )
    .spawn();
    let mut watcher = peers::Running(watcher.expect("the watcher"));
    let mut words = Words::of(&mut watcher);
    assert_seen(&mut words);
    let answers: Vec<_> = (0..3).map(|_| words.next()).collect();
    assert_eq!(answers[0]["success"], true, "{answers:?}");
    assert!(
        answers[0]["message"]
            .to_string()
            .contains("stop requested by the ROS 2 node /feeler"),
        "{answers:?}"
    );
    assert_eq!(answers[1]["success"], true, "{answers:?}");
    assert_eq!(answers[2]["success"], false, "{answers:?}");
    assert!(
        answers[2]["message"].to_string().contains("not stopped"),
        "{answers:?}"
    );
    hand.signal("INT");
    hand.wait();
}
