//! Stop and resume orders, and the rights to give them.

use super::faults::{NO_HURRY, check};
use crate::program::Ended;
use crate::rig::{Setup, certificates, connect};
use feeler_link::messages::message::{PROTOCOL, ResumeMessage};
use feeler_link::transport::{Topic, send};
use feeler_record::Phase;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

#[test]
fn hand_obeys_stop_and_resume_orders() {
    let mut rig = Setup::new("link-orders").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let told = rig.setup.order("stop", &[]).done();
    assert!(
        told.contains("is stopped: stop requested by the test"),
        "{told}"
    );
    hand.wait_for("stopped: stop requested by the test");
    let told = rig.resume(&hand);
    assert!(told.contains("has resumed"), "{told}");
    hand.wait_for("resuming");
    let told = rig.setup.order("resume", &[]);
    assert!(told.stdout.contains("not stopped"), "{told:?}");
    check(&mut rig, hand, "stop requested by the test");
}

#[test]
fn stops_by_two_clients_need_two_resumes() {
    let mut rig = Setup::new("link-two-stops").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let order = |order: &str, more: &[&str]| {
        let more: Vec<String> = more.iter().map(ToString::to_string).collect();
        rig.setup.order(order, &more)
    };
    // `order` uses the name "the test"; `order_from` uses the given one.
    order("stop", &[]).done();
    let of_door = rig.setup.order_from("stop", "the door\u{1b}[2J").done();
    assert!(of_door.contains("stop "), "{of_door}");
    let first = order("resume", &[]);
    assert_eq!(first.status, Some(1), "{first:?}");
    let listed = first.stdout.contains("the door\\u{1b}[2J") && !first.stdout.contains('\u{1b}');
    assert!(listed, "{first:?}");
    assert!(!hand.said().contains("resuming") && !hand.said().contains('\u{1b}'));
    // Only the door's stop is left, and other clients need its number to resume it.
    let passer_by = rig.setup.order_from("resume", "a passer-by");
    assert_eq!(passer_by.status, Some(2), "{passer_by:?}");
    assert!(passer_by.stderr.contains("--number"), "{passer_by:?}");
    let setup = &rig.setup;
    let mut unknown = setup.command(0, &["resume", setup.experiment, "--number=99"]);
    unknown.args(["--connect", &setup.endpoint]);
    let unknown = Ended::of(unknown.output().expect("the program"));
    assert_eq!(unknown.status, Some(2), "{unknown:?}");
    let expected = "--number 99: expected the number of one of these stops";
    assert!(unknown.stderr.contains(expected), "{unknown:?}");
    rig.resume_from(&hand, "the door\u{1b}[2J");
    hand.wait_for("resuming");
    check(&mut rig, hand, "stop requested by the test");
}

/// Resume messages with guessed numbers do not resume later stops.
#[test]
fn stop_ignores_resumes_with_other_numbers() {
    let mut rig = Setup::new("link-resumes").with(&[NO_HURRY]).start();
    let hand = rig.moving_hand(&[]);
    let peer = connect(&rig.setup.endpoint);
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                for number in [0, 1, u64::MAX] {
                    let from = "a flood".into();
                    let resume = ResumeMessage {
                        protocol: PROTOCOL,
                        from,
                        number,
                    };
                    send(&*peer, Topic::Resume, &resume).expect("a link");
                }
                thread::sleep(Duration::from_millis(5));
            }
        });
        // The first stop has a number that the flood contains.
        let orders = [(); 2].map(|()| rig.setup.order("stop", &[]));
        thread::sleep(Duration::from_millis(500));
        over.store(true, Ordering::Relaxed);
        let [first, second] = orders;
        assert!(!first.stdout.contains("the hand is stopped"), "{first:?}");
        let second = second.done();
        assert!(second.contains("the hand is stopped"), "{second}");
    });
    check(&mut rig, hand, "stop requested by the test");
    let task = rig.setup.recording().task;
    let since = task.iter().rposition(|step| !step.reason.is_empty());
    let held = &task[since.expect("the second stop")..];
    assert!(held.iter().all(|step| step.phase == Phase::Stopped));
}

/// A client name that would make heartbeat and mode messages too large is truncated.
#[test]
fn long_client_name_is_truncated() {
    let mut rig = Setup::new("link-long-name").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    let name = "x".repeat(65_519);
    let told = rig.setup.order_from("stop", &name).done();
    assert!(told.contains("the hand is stopped"), "{told}");
    hand.wait_for("stopped: stop requested by xxx");
    rig.resume_from(&hand, &name);
    hand.wait_for("resuming");
    check(&mut rig, hand, "stop requested by xxx");
}

#[test]
fn only_programs_with_a_certificate_of_the_lab_can_connect() {
    let setup = Setup::new("link-certificates").with(&[NO_HURRY]);
    let mut setup = setup.with_certificates("127.0.0.1", "127.0.0.1");
    let elsewhere = certificates(&setup.folder, "elsewhere", "127.0.0.1");
    let lab = std::mem::replace(&mut setup.link, elsewhere.clone());
    let mut strangers = setup.start();
    let hand = strangers.setup.hand(&[]);
    // An order fails after five seconds without a message from the hand. In that time a stranger's sensors and world
    // would have connected, if they could.
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
    assert!(!hand.said().contains("stop requested"), "{}", hand.said());
    rig.setup.order("stop", &lab).done();
    hand.wait_for("stopped: stop requested by the test");
    check(&mut rig, hand, "stop requested by the test");
}

#[test]
fn listening_on_all_interfaces_requires_insecure() {
    let mut setup = Setup::new("link-open");
    setup.endpoint = setup.endpoint.replace("127.0.0.1", "0.0.0.0");
    let (status, said) = setup.hand(&[]).wait();
    assert_eq!(status, Some(2), "{said}");
    let asked = said.contains("anyone on the network") && said.contains("--insecure");
    assert!(asked, "{said}");
}
