//! Where nothing goes wrong, several programs do what one does.

use crate::rig::{Rig, STALE, count};

fn same_as_in_one_program(name: &str, settings: &[&str]) {
    let rig = Rig::new(name, "max").with(settings);
    let others = rig.others(&[]);
    let ended = rig.hand(&[]).end();
    others.interrupt();
    let (apart, alone) = (rig.recorded(), rig.in_one_program());
    assert!(apart.summary["digest"].is_string(), "{ended:?}");
    assert_eq!(
        apart.summary["digest"], alone.summary["digest"],
        "{ended:?}"
    );
}

#[test]
fn in_step_the_cap_closes_bit_for_bit_as_in_one_program() {
    same_as_in_one_program("in-step", &["--sensing=direct"]);
}

#[test]
fn in_step_pictures_are_sensed_bit_for_bit_as_in_one_program() {
    same_as_in_one_program("in-step-image", &["--sensing=image", "--set=time_limit=2"]);
}

/// On the wall clock every run is another one: all claims hold in each, not the digest. Other tests keep the
/// processors busy meanwhile, so data may be a tenth of a second old here.
#[test]
fn in_real_time_the_cap_closes_and_all_claims_hold() {
    let rig =
        Rig::new("real-time", "1").with(&["--sensing=direct", "--set=control.stale_periods=10"]);
    let others = rig.others(&[]);
    let ended = rig.hand(&[]).end();
    let world = others.interrupt();
    assert_eq!(ended.status, Some(0), "{ended:?}\n{world:?}");
    assert!(ended.stdout.contains("8 of 8"), "{ended:?}");
    assert_eq!(rig.recorded().claims(), 8);
    assert_eq!(count(&world, STALE), 0, "{world:?}");
}
