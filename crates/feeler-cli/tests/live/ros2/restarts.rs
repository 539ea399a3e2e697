//! Nodes, routers and hands that are restarted.

use super::node::replay;
use super::peers::{Running, Words, pyzeros, script};
use super::rig::node;
use crate::ports::unused_endpoint;
use crate::program::folder;
use crate::rig::Setup;
use std::fs;

/// Starts a router at `endpoint`.
fn router(python: &str, endpoint: &str) -> Running {
    let router = script(python, "router.py", &[endpoint]).spawn();
    let mut router = Running(router.expect("a router"));
    assert_eq!(Words::of(&mut router).next()["ready"], true);
    router
}

/// Asserts that a late subscriber, connected through the router at `endpoint`, receives the latched messages.
fn assert_told_late(python: &str, endpoint: &str) {
    let watcher = script(python, "late.py", &[endpoint]).spawn();
    let mut watcher = Running(watcher.expect("a watcher"));
    let told = Words::of(&mut watcher).next();
    assert!(
        told["description"].to_string().contains("<robot name="),
        "{told}"
    );
    assert!(told["frames"].to_string().contains("finger_0"), "{told}");
}

#[test]
fn late_subscriber_receives_latched_messages_after_a_router_restart() {
    let Some(python) = pyzeros() else { return };
    let endpoint = unused_endpoint();
    // The node starts first and waits for the router.
    let mut node = replay(&folder("ros2-router"), &["--ros-connect", &endpoint]);
    for _ in 0..2 {
        // Dropping the router kills it.
        let _router = router(&python, &endpoint);
        assert_told_late(&python, &endpoint);
    }
    assert!(node.0.try_wait().expect("its status").is_none());
}

#[test]
fn node_survives_its_hand_and_does_not_block_it_when_frozen() {
    let Some(python) = pyzeros() else { return };
    let rig = Setup::new("ros2-restarts")
        .with(&["time_limit=600"])
        .start();
    let mut hand = rig.moving_hand(&[]);
    let graph = unused_endpoint();
    let mut node = node(&rig, "ros2", &graph);
    node.wait_for("is the ROS 2 node");
    node.wait_for("nothing found at tcp/127.0.0.1:");
    node.signal("STOP");
    let told = rig.setup.order("stop", &[]).done();
    assert!(told.contains("the hand is stopped"), "{told}");
    rig.resume(&hand);
    node.signal("CONT");

    hand.kill();
    fs::remove_dir_all(rig.setup.folder.join("run")).expect("the run");
    let _hand = rig.moving_hand(&[]);
    assert!(node.is_running(), "{}", node.said());
    let watcher = script(&python, "watch.py", &[&graph, "/stop", "/resume"]).spawn();
    let mut watcher = Running(watcher.expect("the watcher"));
    let mut words = Words::of(&mut watcher);
    super::node::assert_seen(&mut words);
    for _ in 0..2 {
        let answer = words.next();
        assert_eq!(answer["success"], true, "{answer}");
    }
}
