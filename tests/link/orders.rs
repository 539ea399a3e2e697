//! `feeler stop` and `feeler resume`.

use crate::faults::{DIRECT, waits};
use crate::rig::Rig;

#[test]
fn a_hand_stops_and_goes_on_as_it_is_told_and_closes_the_cap() {
    let rig = Rig::new("orders", "1").with(&[DIRECT, "--set=control.stale_periods=10"]);
    let others = rig.others(&[]);
    let hand = rig.hand(&[]);
    rig.wait_for_record(300_000);
    let from = ["--from", "the one at the bench"];
    assert_eq!(rig.order("stop", &from).status, Some(0));
    let reason = "told to stop by the one at the bench";
    let said = hand.wait_to_warn(reason, 0);
    waits(&hand, said);
    rig.resume(&hand, said);
    let ended = hand.end();
    others.interrupt();
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let recorded = rig.recorded();
    let stops = recorded.stops();
    assert!(stops.iter().any(|stop| stop.reason == reason), "{stops:?}");
    let alone = rig.in_one_program();
    let turned = |recorded: &crate::promises::Recorded| recorded.summary["cap_angle"].as_f64();
    let (here, alone) = (turned(&recorded), turned(&alone));
    // The cap's last thread is as tight however it came there.
    let difference = (here.unwrap() - alone.unwrap()).abs();
    assert!(difference < 0.1, "{here:?} and {alone:?} rad");
}

#[test]
fn an_order_to_no_hand_is_refused() {
    let rig = Rig::new("no-hand", "1");
    rig.order("stop", &[])
        .refused(&["no hand of rig", "cap-closing"]);
}
