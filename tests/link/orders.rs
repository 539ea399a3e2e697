//! Orders from anywhere, and who may give them.

use super::program::{folder, run};
use super::rig::{Rig, Running, alone, reasons};

#[test]
fn a_hand_stops_when_told_to_and_goes_on_when_told_to() {
    let settings = ["--sensing=direct", "--set=time_limit=600"];
    let rig = Rig::start(folder("link-orders"), "1", &settings);
    let mut hand = rig.hand(&[]);
    std::thread::sleep(std::time::Duration::from_secs(2));
    rig.order("stop").done();
    hand.wait_for("stopped: told to stop by the test");
    rig.order("resume").done();
    hand.wait_for("going on");
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
    let reasons = reasons(&rig.recording());
    assert!(
        reasons.contains(&"told to stop by the test".to_string()),
        "{reasons:?}"
    );
}

#[test]
fn only_who_has_a_certificate_of_the_lab_takes_part() {
    let _alone = alone();
    let folder = folder("link-certificates");
    run(&folder, &["certificates", "lab", "127.0.0.1"]).done();
    run(&folder, &["certificates", "elsewhere", "127.0.0.1"]).done();
    run(&folder, &["certificates", "lab", "127.0.0.1"]).refused(&["there already"]);
    let port = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let endpoint = format!("tls/{}", port.local_addr().expect("its address"));
    drop(port);
    let hand = [
        "hand",
        "cap-closing",
        "--sensing=direct",
        "--certificates=lab/127.0.0.1",
    ];
    let hand = [&hand[..], &["--listen", &endpoint]].concat();
    let mut hand = Running::start(&folder, "hand", &hand);
    hand.wait_for("waiting for");
    let stop = ["stop", "cap-closing", "--connect", &endpoint];
    run(&folder, &stop).refused(&["--certificates"]);
    let stranger = [&stop[..], &["--certificates=elsewhere/127.0.0.1"]].concat();
    run(&folder, &stranger).refused(&["no hand of rig"]);
    let friend = [&stop[..], &["--certificates=lab/127.0.0.1"]].concat();
    run(&folder, &friend).done();
}
