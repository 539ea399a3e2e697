//! A running rig as a node: its hand is stopped and resumed by services.

use crate::node::assert_seen;
use crate::peers::{Running, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use crate::program::{feeler, folder};
use std::fs::File;
use std::process::Stdio;

#[test]
fn another_implementation_stops_and_resumes_the_hand_of_a_rig() {
    let Some(python) = pyzeros() else { return };
    let folder = folder("ros2-rig");
    let (hand, ros) = (unused_endpoint(), unused_endpoint());
    let mut running = Vec::new();
    let mut start = |name: &str, arguments: &[&str]| {
        let log = File::create(folder.join(format!("{name}.log"))).expect("a file");
        let mut command = feeler(&folder, arguments);
        command.stdout(Stdio::null()).stderr(log);
        running.push(Running(command.spawn().expect(name)));
    };
    // At a tenth of real time no busy computer makes data stale.
    let of_rig = ["cap-closing", "--sensing", "direct"];
    let slow = ["--speed", "0.1"];
    start(
        "hand",
        &[
            &["hand"],
            &of_rig[..],
            &slow,
            &["--listen", &hand, "--out", "run"],
        ]
        .concat(),
    );
    for finger in ["0", "1"] {
        let sense = [
            "sense",
            "rig:",
            "--finger",
            finger,
            "--publish",
            "--sensing",
            "direct",
            "--connect",
            &hand,
        ];
        start(&format!("sense-{finger}"), &sense);
    }
    start(
        "world",
        &[&["world"], &of_rig[..], &slow, &["--connect", &hand]].concat(),
    );
    let places = [
        "--connect",
        &hand,
        "--ros-listen",
        &ros,
        "--ros-connect",
        &unused_endpoint(),
        "--domain-id",
        "0",
    ];
    start("ros2", &[&["ros2"], &of_rig[..], &places].concat());

    let watcher = script(&python, "watch.py", &[&ros, "/stop", "/resume", "/resume"]).spawn();
    let mut watcher = Running(watcher.expect("the watcher"));
    let mut words = Words::of(&mut watcher);
    assert_seen(&mut words);
    let answers: Vec<_> = (0..3).map(|_| words.next()).collect();
    assert_eq!(answers[0]["success"], true, "{answers:?}");
    assert!(
        answers[0]["message"]
            .to_string()
            .contains("told to stop by the ROS 2 node /feeler"),
        "{answers:?}"
    );
    assert_eq!(answers[1]["success"], true, "{answers:?}");
    assert_eq!(answers[2]["success"], false, "{answers:?}");
    assert!(
        answers[2]["message"].to_string().contains("not stopped"),
        "{answers:?}"
    );
}
