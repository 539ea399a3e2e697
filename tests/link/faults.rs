//! What goes wrong stops the hand, and is said; it goes on when told to.

use super::program::folder;
use super::rig::{Rig, Running, ages_of_moves, reasons};
use std::net::TcpListener;

/// Control periods that data may be old, and the control period, s: as the reference experiment has them.
const STALE: f64 = 3.5;
const PERIOD: f64 = 0.01;

/// The rig, and its hand that has begun to move.
fn moving(name: &str, more: &[&str]) -> (Rig, Running) {
    let settings = ["--sensing=direct", "--set=time_limit=600"];
    let rig = Rig::start(folder(name), "1", &settings);
    let mut hand = rig.hand(more);
    let log = rig.folder.join("run/recording.mcap");
    hand.wait_for("waiting for");
    let start = std::time::Instant::now();
    while !log.exists() {
        assert!(start.elapsed().as_secs() < 90, "{}", hand.said());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    // It approaches the cap for half a second.
    std::thread::sleep(std::time::Duration::from_millis(300));
    (rig, hand)
}

/// Ends the hand and holds its record to the promises: a reason for each stop, among them `words`, and no
/// move on stale data.
fn check(rig: &Rig, mut hand: Running, words: &str) {
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
    let recording = rig.recording();
    let reasons = reasons(&recording);
    assert!(
        reasons.iter().any(|reason| reason.contains(words)),
        "{reasons:?}, {said}"
    );
    let oldest = ages_of_moves(&recording).into_iter().fold(0.0, f64::max);
    assert!(oldest <= STALE * PERIOD + 1e-9, "{oldest} s, {said}");
    rig.world.signal("INT");
}

/// What the world says at its end.
fn worlds_end(rig: &mut Rig) -> String {
    let (status, said) = rig.world.wait();
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("0 stale commands refused"), "{said}");
    said
}

#[test]
fn a_sensor_program_that_is_killed_stops_the_hand_until_it_is_told_to_go_on() {
    let (mut rig, mut hand) = moving("link-killed", &[]);
    rig.senses[1].signal("KILL");
    hand.wait_for("stopped: the forces of finger 1");
    rig.start_sense(1);
    // It is heard after its first heartbeat; the hand refuses to go on before.
    let start = std::time::Instant::now();
    while !hand.said().contains("going on") {
        assert!(start.elapsed().as_secs() < 90, "{}", hand.said());
        rig.order("resume").done();
    }
    check(&rig, hand, "the forces of finger 1");
    worlds_end(&mut rig);
}

#[test]
fn a_sensor_program_that_is_frozen_stops_the_hand_which_may_go_on_by_itself() {
    let settings = ["--set=control.resume=fresh"];
    let all = ["--sensing=direct", "--set=time_limit=600", settings[0]];
    let mut rig = Rig::start(folder("link-frozen"), "1", &all);
    let mut hand = rig.hand(&[]);
    std::thread::sleep(std::time::Duration::from_secs(2));
    rig.senses[0].signal("STOP");
    hand.wait_for("stopped: the forces of finger 0");
    rig.senses[0].signal("CONT");
    hand.wait_for("going on");
    check(&rig, hand, "the forces of finger 0");
    worlds_end(&mut rig);
}

#[test]
fn a_world_that_is_frozen_stops_the_hand() {
    let (mut rig, mut hand) = moving("link-still", &[]);
    rig.world.signal("STOP");
    hand.wait_for("stopped: the joint angles");
    rig.world.signal("CONT");
    check(&rig, hand, "the joint angles");
    worlds_end(&mut rig);
}

#[test]
fn a_bad_network_stops_the_hand_and_never_makes_it_move_on_stale_data() {
    let (mut rig, mut hand) = moving(
        "link-bad",
        &["--rehearse=loss=0.2,jitter=0.05,duplicate=0.1"],
    );
    hand.wait_for("stopped:");
    check(&rig, hand, "s old (limit");
    worlds_end(&mut rig);
}

#[test]
fn a_hand_that_is_killed_leaves_the_rig_to_its_watchdog() {
    let (mut rig, hand) = moving("link-watchdog", &[]);
    hand.signal("KILL");
    std::thread::sleep(std::time::Duration::from_millis(500));
    rig.world.signal("INT");
    let said = worlds_end(&mut rig);
    assert!(said.contains("1 stops by the watchdog"), "{said}");
}

#[test]
fn programs_that_do_not_agree_are_refused_and_both_are_named() {
    let rig = Rig::start(folder("link-other"), "1", &["--sensing=direct"]);
    let (status, said) = rig.hand(&["--seed=9"]).wait();
    assert_eq!(status, Some(2), "{said}");
    assert!(
        said.contains("works by experiment") && said.contains("this by"),
        "{said}"
    );
}

#[test]
fn nobody_listens_beyond_this_computer_unasked() {
    let folder = folder("link-open");
    let port = TcpListener::bind("127.0.0.1:0")
        .expect("a port")
        .local_addr();
    let listen = format!("--listen=tcp/0.0.0.0:{}", port.expect("its number").port());
    let refused = super::program::run(&folder, &["hand", "cap-closing", &listen]);
    refused.refused(&["anybody on the network", "--insecure"]);
}
