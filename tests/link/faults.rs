//! Programs that die or hang, and a bad network: the hand stops, and goes on when it is told to.

use crate::process::Process;
use crate::rig::{Others, Rig, STALE, WATCHDOG, count};
use std::thread;
use std::time::Duration;

pub const DIRECT: &str = "--sensing=direct";
pub const BY_ITSELF: &str = "--set=control.resume=fresh";

/// Strikes when the hand has moved for a while; how many lines it had said when it stopped for `reason`.
fn strike(rig: &Rig, hand: &Process, reason: &str, fault: impl FnOnce()) -> usize {
    rig.wait_for_record(300_000);
    let said = hand.warnings();
    fault();
    hand.wait_to_warn(reason, said)
}

/// Ends all programs; asserts that the hand stopped for `reason` and kept its promises.
fn held(rig: &Rig, hand: Process, others: Others, reason: &str) {
    let ended = hand.interrupt();
    let world = others.interrupt();
    assert_eq!(count(&world, STALE), 0, "{ended:?}\n{world:?}");
    let stops = rig.recorded().keeps_its_promises();
    let found = stops.iter().any(|stop| stop.reason.contains(reason));
    assert!(found, "no {reason:?} in {stops:?}");
}

/// Gives a hand that may not go on the time to do it.
pub fn waits(hand: &Process, said: usize) {
    thread::sleep(Duration::from_millis(700));
    assert_eq!(hand.warnings(), said, "it went on untold");
}

#[test]
fn when_a_sensor_program_is_killed_the_hand_stops_until_it_is_told_to_go_on() {
    let rig = Rig::new("killed", "1").with(&[DIRECT]);
    let mut others = rig.others(&[]);
    let hand = rig.hand(&[]);
    let killed = others.senses.remove(0);
    let reason = "stopped: the forces of finger 0";
    let said = strike(&rig, &hand, reason, || killed.signal("KILL"));
    others.senses.push(rig.sense(0, &[]));
    waits(&hand, said);
    let said = rig.resume(&hand, said);
    rig.wait_for_more_record();
    assert!(hand.warnings() >= said);
    held(&rig, hand, others, &reason["stopped: ".len()..]);
}

#[test]
fn when_a_sensor_program_hangs_the_hand_stops_until_it_is_told_to_go_on() {
    let rig = Rig::new("frozen", "1").with(&[DIRECT]);
    let others = rig.others(&[]);
    let hand = rig.hand(&[]);
    let reason = "stopped: the forces of finger 1";
    let said = strike(&rig, &hand, reason, || others.senses[1].signal("STOP"));
    waits(&hand, said);
    others.senses[1].signal("CONT");
    waits(&hand, said);
    rig.resume(&hand, said);
    rig.wait_for_more_record();
    held(&rig, hand, others, &reason["stopped: ".len()..]);
}

#[test]
fn a_hand_that_may_goes_on_by_itself_once_a_hanging_sensor_program_is_back() {
    let rig = Rig::new("fresh", "1").with(&[DIRECT, BY_ITSELF]);
    let others = rig.others(&[]);
    let hand = rig.hand(&[]);
    let reason = "stopped: the forces of finger 1";
    let said = strike(&rig, &hand, reason, || others.senses[1].signal("STOP"));
    thread::sleep(Duration::from_secs(1));
    others.senses[1].signal("CONT");
    hand.wait_to_warn("going on", said);
    rig.wait_for_more_record();
    held(&rig, hand, others, &reason["stopped: ".len()..]);
}

#[test]
fn a_sensor_program_that_comes_back_to_a_taken_place_is_not_heard() {
    let rig = Rig::new("replaced", "1").with(&[DIRECT]);
    let mut others = rig.others(&[]);
    let hand = rig.hand(&[]);
    let reason = "stopped: the forces of finger 0";
    let said = strike(&rig, &hand, reason, || others.senses[0].signal("STOP"));
    let other = rig.sense(0, &[]);
    rig.resume(&hand, said);
    let said = hand.warnings();
    others.senses[0].signal("CONT");
    hand.wait_to_warn("refused: there is sense of finger 0 already", said);
    others.senses.push(other);
    held(&rig, hand, others, &reason["stopped: ".len()..]);
}

/// Messages are lost, late, repeated, and overtake each other.
const BAD: &str = "--rehearse=loss=0.2,jitter=0.05,duplicate=0.1";

#[test]
fn over_a_bad_network_to_the_hand_nothing_is_done_on_stale_data() {
    let rig = Rig::new("bad", "1").with(&[DIRECT, BY_ITSELF]);
    let others = rig.others(&[]);
    let hand = rig.hand(&[BAD]);
    hand.wait_to_warn("stopped:", 0);
    rig.wait_for_record(3_000_000);
    held(&rig, hand, others, " s old (limit");
}

#[test]
fn over_a_bad_network_everywhere_the_hand_stops_rather_than_move_on_stale_data() {
    let rig = Rig::new("worse", "1").with(&[DIRECT, BY_ITSELF]);
    let others = rig.others(&[BAD]);
    let hand = rig.hand(&[BAD]);
    let said = hand.wait_to_warn("stopped:", 0);
    let said = hand.wait_to_warn("going on", said);
    hand.wait_to_warn("stopped:", said);
    // What is late on its way to the rig is refused there: that is no fault of the hand's.
    let ended = hand.interrupt();
    others.interrupt();
    let stops = rig.recorded().keeps_its_promises();
    assert!(stops.len() >= 2, "{ended:?}");
}

#[test]
fn when_the_hand_is_killed_the_rig_stops_by_its_own_watchdog() {
    let rig = Rig::new("watchdog", "1").with(&[DIRECT]);
    let others = rig.others(&[]);
    let hand = rig.hand(&[]);
    rig.wait_for_record(300_000);
    hand.signal("KILL");
    drop(hand);
    // The next hand finds how the joints stand before it moves them.
    let next = rig.hand_in("next", &[]);
    next.wait_to_say("waiting for");
    rig.wait_for_record_of("next", 100_000);
    next.interrupt();
    let world = others.interrupt();
    assert!(count(&world, WATCHDOG) >= 1, "{world:?}");
    let velocities = rig.recorded_in("next").first_velocities();
    assert!(velocities.iter().all(|v| v.abs() < 1e-6), "{velocities:?}");
}
