//! Finger speed estimator (paper, Fig. 5) for all combinations of mode and flags.

use feeler::control::law::tri_axial::{Reflex, TriAxialLaw};
use feeler::control::{FingerFlags, Plan};
use glam::DVec3;

const REFLEX: Reflex = Reflex {
    recompression_speed: 0.003,
    minimum_grasp_force: 0.7,
};
const SEARCH: Plan = Plan {
    velocity: DVec3::new(0.004, 0.0, 0.0),
    towards_object: DVec3::X,
    reflex: true,
    keep_grasp: false,
};
const MOVE: Plan = Plan {
    velocity: DVec3::new(0.0, -0.010, 0.0),
    towards_object: DVec3::X,
    reflex: true,
    keep_grasp: true,
};
/// Outward normal of the element with the largest F_z.
const PRESSING: DVec3 = DVec3::new(0.6, 0.0, 0.8);

fn flags(slip: bool, over: bool, grasp_force: f64) -> FingerFlags {
    FingerFlags {
        touch: true,
        slip,
        over,
        largest_element: Some(0),
        grasp_force,
    }
}

fn estimate(plan: &Plan, flags: &FingerFlags, pressing: Option<DVec3>) -> DVec3 {
    TriAxialLaw::new(REFLEX).estimate(plan, flags, pressing)
}

#[test]
fn slip_recompresses_the_largest_element_unless_one_is_over() {
    for plan in [SEARCH, MOVE] {
        for (slip, over) in [(false, false), (false, true), (true, false), (true, true)] {
            let reflex = if slip && !over {
                0.003 * PRESSING
            } else {
                DVec3::ZERO
            };
            let actual = estimate(&plan, &flags(slip, over, 1.0), Some(PRESSING));
            assert_eq!(actual, plan.velocity + reflex, "slip {slip}, over {over}");
        }
    }
}

#[test]
fn slip_without_a_touching_element_has_no_effect() {
    assert_eq!(
        estimate(&MOVE, &flags(true, false, 1.0), None),
        MOVE.velocity
    );
}

#[test]
fn slip_without_the_reflex_has_no_effect() {
    let plan = Plan {
        reflex: false,
        ..SEARCH
    };
    assert_eq!(
        estimate(&plan, &flags(true, false, 0.0), Some(PRESSING)),
        plan.velocity
    );
}

#[test]
fn a_weak_grasp_is_increased_only_in_move() {
    let weak = flags(false, false, 0.699);
    assert_eq!(estimate(&SEARCH, &weak, Some(PRESSING)), SEARCH.velocity);
    let pressed = MOVE.velocity + 0.003 * PRESSING;
    assert_eq!(estimate(&MOVE, &weak, Some(PRESSING)), pressed);
    assert_eq!(
        estimate(&MOVE, &flags(false, false, 0.7), Some(PRESSING)),
        MOVE.velocity
    );
    // Without contact, it moves towards the object's expected position.
    assert_eq!(
        estimate(&MOVE, &weak, None),
        MOVE.velocity + 0.003 * DVec3::X
    );
    assert_eq!(
        estimate(&MOVE, &flags(false, true, 0.5), Some(PRESSING)),
        MOVE.velocity
    );
    // A weak, slipping grasp is recompressed once, not twice.
    assert_eq!(
        estimate(&MOVE, &flags(true, false, 0.5), Some(PRESSING)),
        pressed
    );
}

#[test]
fn the_velocity_is_kept_while_the_flags_are_unchanged() {
    let mut estimator = TriAxialLaw::new(REFLEX);
    let first = estimator.estimate(&MOVE, &flags(true, false, 1.0), Some(PRESSING));
    // The largest element changes, but the flags and therefore the velocity do not.
    let other = Some(DVec3::X);
    assert_eq!(
        estimator.estimate(&MOVE, &flags(true, false, 2.0), other),
        first
    );
    let calm = estimator.estimate(&MOVE, &flags(false, false, 1.0), other);
    assert_eq!(calm, MOVE.velocity);
    let again = estimator.estimate(&MOVE, &flags(true, false, 1.0), other);
    assert_eq!(again, MOVE.velocity + 0.003 * DVec3::X);
    // A new plan takes effect immediately.
    let search = estimator.estimate(&SEARCH, &flags(true, false, 1.0), other);
    assert_eq!(search, SEARCH.velocity + 0.003 * DVec3::X);
}
