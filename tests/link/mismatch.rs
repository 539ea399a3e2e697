//! Programs that do not belong to the rig, by mistake.

use crate::faults::DIRECT;
use crate::rig::Rig;

const OTHER: &str = "--set=seed=9";

#[test]
fn a_hand_ends_where_a_program_works_by_another_experiment() {
    let rig = Rig::new("other-world", "1").with(&[DIRECT]);
    let _world = rig.world(&[OTHER]);
    rig.hand(&[]).end().refused(&[
        "world works by experiment",
        "this by",
        "same file and settings",
    ]);
    let rig = Rig::new("other-sense", "1").with(&[DIRECT]);
    let _sense = rig.sense(1, &[OTHER]);
    rig.hand(&[])
        .end()
        .refused(&["sense of finger 1 works by experiment", "this by"]);
}

#[test]
fn a_running_rig_goes_on_whatever_program_comes_that_does_not_belong_to_it() {
    let rig = Rig::new("intruders", "1").with(&[DIRECT]);
    let mut others = rig.others(&[]);
    let mut hand = rig.hand(&[]);
    rig.wait_for_record(300_000);

    rig.sense(1, &[OTHER])
        .end()
        .refused(&["works by experiment", "this by"]);
    let second = rig.sense(1, &[]);
    hand.wait_to_warn("refused: there is sense of finger 1 already", 0);
    second.interrupt();

    let port = Rig::new("second-hand", "1").endpoint;
    let connect = format!("--connect={}", rig.endpoint);
    let second = rig.hand_at(&port, "second", &[&connect]);
    hand.wait_to_warn("refused: there is hand already", 0);
    assert!(hand.is_running());
    second.end().refused(&["there is hand already"]);

    rig.wait_for_more_record();
    assert!(others.world.is_running());
    for sense in &mut others.senses {
        assert!(sense.is_running(), "a sensor program left");
    }
    hand.interrupt();
    others.interrupt();
    rig.recorded().keeps_its_promises();
}
