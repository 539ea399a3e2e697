//! Orders from anywhere, and who may give them.

use super::faults::{NO_HURRY, check};
use super::rig::{Setup, certificates};

#[test]
fn a_hand_stops_when_told_to_and_goes_on_when_told_to() {
    let mut rig = Setup::new("link-orders").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let told = rig.setup.order("stop", &[]).done();
    assert!(
        told.contains("stands still: told to stop by the test"),
        "{told}"
    );
    hand.wait_for("stopped: told to stop by the test");
    let told = rig.setup.order("resume", &[]).done();
    assert!(told.contains("goes on"), "{told}");
    hand.wait_for("going on");
    check(&mut rig, hand, "told to stop by the test");
}

#[test]
fn only_who_has_a_certificate_of_the_lab_takes_part() {
    let setup = Setup::new("link-certificates").with(&[NO_HURRY]);
    let mut setup = setup.with_certificates("127.0.0.1", "127.0.0.1");
    let elsewhere = certificates(&setup.folder, "elsewhere", "127.0.0.1");
    let lab = std::mem::replace(&mut setup.link, elsewhere.clone());
    let mut strangers = setup.start();
    let hand = strangers.setup.hand(&[]);
    // An order is given up when nothing of the hand was heard for five seconds: time for a stranger's
    // sensors and world to be heard, if they could be.
    let by = |link: &[String]| strangers.setup.order("stop", link);
    by(&elsewhere).refused(&["no hand of rig"]);
    by(&[]).refused(&["--certificates"]);
    assert!(
        !strangers.setup.folder.join("run").exists(),
        "{}",
        hand.said()
    );
    drop(hand);

    strangers.setup.link = lab.clone();
    let setup = strangers.setup.clone();
    drop(strangers);
    let mut rig = setup.start();
    let mut hand = rig.moving_hand(&[]);
    rig.setup
        .order("stop", &elsewhere)
        .refused(&["no hand of rig"]);
    assert!(!hand.said().contains("told to stop"), "{}", hand.said());
    rig.setup.order("stop", &lab).done();
    hand.wait_for("stopped: told to stop by the test");
    check(&mut rig, hand, "told to stop by the test");
}

#[test]
fn nobody_listens_beyond_this_computer_unasked() {
    let mut setup = Setup::new("link-open");
    setup.endpoint = setup.endpoint.replace("127.0.0.1", "0.0.0.0");
    let (status, said) = setup.hand(&[]).wait();
    assert_eq!(status, Some(2), "{said}");
    let asked = said.contains("anybody on the network") && said.contains("--insecure");
    assert!(asked, "{said}");
}
