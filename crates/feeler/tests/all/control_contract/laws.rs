//! Control laws other than the paper's: which data each uses, and that they neither allocate nor command unsafe
//! motion.

use super::rig::{Analyzers, ELEMENTS, config, controller, hand_at_home, layout, pressed, state};
use assert_no_alloc::assert_no_alloc;
use feeler::control::law::best::{Best, BestConfig};
use feeler::control::law::{Law, LawConfig, normal_only::NormalOnlyConfig};
use feeler::control::{FingerReadings, FingertipPose, Plan, TactileReading};
use feeler::hand::{Hand, HandCommand, JointState};
use glam::DVec3;

const MOVE: Plan = Plan {
    velocity: DVec3::new(0.0, -0.010, 0.0),
    towards_object: DVec3::X,
    reflex: true,
    keep_grasp: true,
};

/// Reading of a finger at the origin of W whose apex element, along x, measures `force`.
fn touch(sequence: u64, force: DVec3) -> TactileReading {
    let mut touch = TactileReading::none(ELEMENTS);
    touch.frame.sequence = sequence;
    touch.frame.stamp = 0.01 * sequence as f64;
    touch.frame.forces[0] = force;
    touch.flags.grasp_force = force.z;
    touch.flags.largest_element = Some(0);
    touch
}

/// Speed towards the object that `law` requests if its apex element measures `force`.
fn pressing(law: &mut dyn Law, sequence: u64, force: DVec3) -> f64 {
    let layout = layout();
    let touch = touch(sequence, force);
    let sense = FingerReadings {
        pose: FingertipPose::default(),
        joints: JointState::default(),
        touch: &touch,
        layout: &layout,
    };
    (law.velocity(&MOVE, &sense) - MOVE.velocity).dot(DVec3::X)
}

fn law(law: LawConfig) -> Box<dyn Law> {
    let control = config().control;
    law.finger_law(control.reflex(), control.touch_force, ELEMENTS)
        .expect("a law")
        .expect("a law for each finger")
}

#[test]
fn no_law_allocates_or_stops_the_hand() {
    for name in LawConfig::NAMES {
        let mut config = config();
        config.control.law = LawConfig::named(name).expect("a law");
        assert_eq!(config.control.law.name(), name);
        let mut controller = controller(&config);
        let mut hand = hand_at_home(&config);
        let mut analyzers = Analyzers::new(&config);
        let mut command = HandCommand::stop(2);
        for n in 0..2000 {
            let force = 2.5 * (0.05 * n as f64).sin().max(0.0);
            let mut frames = vec![pressed(n, hand.stamp, force); 2];
            frames[0].forces[1].x = 0.1 * (n % 3) as f64;
            let (touches, state) = (analyzers.touches(&frames), state(&hand));
            assert_no_alloc(|| controller.decide(&touches, &state, &mut command));
            hand.command(&command).expect("an ideal hand");
        }
        assert_eq!(controller.stop_reason(), None, "{name}");
        assert!(controller.task().stroke() > 1, "{name}");
    }
}

#[test]
fn normal_only_ignores_shear_and_grasps_by_its_assumed_friction() {
    let assumed = NormalOnlyConfig {
        friction: 0.5,
        tangential_load: 1.0,
        ..NormalOnlyConfig::default()
    };
    let mut law = law(LawConfig::NormalOnly(assumed));
    let still = pressing(&mut *law, 1, DVec3::new(0.0, 0.0, 1.5));
    let sheared = pressing(&mut *law, 2, DVec3::new(0.9, -0.4, 1.5));
    assert_eq!(still, sheared);
    // 1 N at a friction of 0.5 requires 2 N.
    assert!(still > 0.0);
    assert_eq!(pressing(&mut *law, 3, DVec3::new(0.0, 0.0, 2.0)), 0.0);
    assert!(pressing(&mut *law, 4, DVec3::new(0.0, 0.0, 2.5)) < 0.0);
}

#[test]
fn open_loop_ignores_forces_and_squeezes_its_distance() {
    let mut law = law(LawConfig::named("open-loop").expect("a law"));
    let squeezing = pressing(&mut *law, 1, DVec3::new(0.0, 0.0, 0.1));
    assert_eq!(squeezing, 0.004);
    assert_eq!(pressing(&mut *law, 2, DVec3::new(3.0, 0.0, 5.0)), squeezing);
}

#[test]
fn best_grasps_in_proportion_to_shear_before_any_slip() {
    let fixed = BestConfig {
        learning_rate: 0.0,
        friction: 0.5,
        margin: 1.5,
        least_grasp_force: 0.2,
        element_force: 1.75,
        slip_share: 0.75,
        ..BestConfig::default()
    };
    let mut law = law(LawConfig::Best(fixed));
    // 0.3 N of shear require 1.5 * 0.3 / 0.5 = 0.9 N of grasp force.
    let at =
        |law: &mut dyn Law, sequence, grasp| pressing(law, sequence, DVec3::new(0.3, 0.0, grasp));
    assert!(at(&mut *law, 1, 0.7) > 0.0);
    assert!(at(&mut *law, 2, 0.9).abs() < 1e-12);
    assert!(at(&mut *law, 3, 1.1) < 0.0);
    // At any shear, no element exceeds its force limit, not even after a slip.
    let much = |law: &mut dyn Law, sequence, force| pressing(law, sequence, force);
    assert!(much(&mut *law, 4, DVec3::new(1.2, 0.0, 1.76)) < 0.0);
    assert!(much(&mut *law, 5, DVec3::new(1.9, 0.0, 1.5)) < 0.0);
    assert!(much(&mut *law, 6, DVec3::new(1.2, 0.0, 1.5)) > 0.0);
}

#[test]
fn best_learns_friction_from_slips() {
    let layout = layout();
    for friction in [0.4, 1.2] {
        let mut law = Best::new(BestConfig::default(), ELEMENTS);
        // A sawtooth between the static limit and 0.7 of it at 1 N, as for a dragging finger.
        for frame in 0..400_u64 {
            let used = 0.7 + 0.3 * (frame % 10) as f64 / 9.0;
            let touch = touch(frame, DVec3::new(friction * used, 0.0, 1.0));
            let sense = FingerReadings {
                pose: FingertipPose::default(),
                joints: JointState::default(),
                touch: &touch,
                layout: &layout,
            };
            law.velocity(&MOVE, &sense);
        }
        // Each slip corrects 0.3 of the error; nothing else changes the estimate here.
        let off = (law.friction() - friction).abs();
        assert!(
            off < 0.01 * friction,
            "{} instead of {friction}",
            law.friction()
        );
    }
}

/// Two elements with different normals are pressed along the mean of their normals, weighted by force.
#[test]
fn best_presses_along_the_mean_normal_of_all_touching_elements() {
    let layout = layout();
    let config = BestConfig {
        learning_rate: 0.0,
        friction: 0.5,
        margin: 1.5,
        least_grasp_force: 2.0,
        element_force: 5.0,
        gain: 0.01,
        pressing_speed: 0.1,
        slip_share: 0.6,
    };
    let mut law = Best::new(config, ELEMENTS);
    let mut touch = touch(1, DVec3::new(0.0, 0.0, 0.6));
    touch.frame.forces[1].z = 0.3;
    // Too small a force to count.
    touch.frame.forces[9].z = 0.019;
    let sense = FingerReadings {
        pose: FingertipPose::default(),
        joints: JointState::default(),
        touch: &touch,
        layout: &layout,
    };
    let [first, second] = [0, 1].map(|i| layout.elements[i].normal());
    let inward = (0.6 * first + 0.3 * second).normalize();
    let pressed = 0.6 * first.dot(inward) + 0.3 * second.dot(inward);
    let expected = 0.01 * (2.0 - pressed) / 2.0 * inward;
    let found = law.velocity(&MOVE, &sense) - MOVE.velocity;
    assert!(found.distance(expected) < 1e-12, "{found} {expected}");
    let search = Plan {
        keep_grasp: false,
        ..MOVE
    };
    assert_eq!(law.velocity(&search, &sense), MOVE.velocity);
}

/// Friction estimate of the law after an element's force changed from `before` to `now`, each `(shear, normal)` (N).
fn believed(before: (f64, f64), now: (f64, f64)) -> f64 {
    let layout = layout();
    let config = BestConfig {
        friction: 0.6,
        learning_rate: 0.5,
        ..BestConfig::default()
    };
    let mut law = Best::new(config, ELEMENTS);
    // Each frame is processed twice, as in control steps without a new frame.
    for (sequence, (shear, normal)) in [(1, before), (1, before), (2, now), (2, now)] {
        let touch = touch(sequence, DVec3::new(shear, 0.0, normal));
        let sense = FingerReadings {
            pose: FingertipPose::default(),
            joints: JointState::default(),
            touch: &touch,
            layout: &layout,
        };
        law.velocity(&MOVE, &sense);
    }
    law.friction()
}

#[test]
fn best_learns_from_slips_and_from_contacts_that_hold_better_than_estimated() {
    for (before, now, expected) in [
        // A decrease of more than 0.04 N at the same normal force: half way from 0.6 to 0.4.
        ((0.4, 1.0), (0.3, 1.0), 0.5),
        ((0.4, 1.0), (0.37, 1.0), 0.6),
        // The normal force also decreased: a release, not a slip.
        ((0.4, 1.0), (0.3, 0.89), 0.6),
        ((0.4, 1.0), (0.3, 0.91), 0.5),
        // The contact sticks at 0.8.
        ((0.8, 1.0), (0.8, 1.0), 0.7),
        ((0.59, 1.0), (0.8, 1.0), 0.6),
        // The normal force is too small in one of the frames.
        ((0.12, 0.14), (0.12, 0.5), 0.6),
        ((0.4, 0.5), (0.12, 0.14), 0.6),
        ((0.128, 0.16), (0.128, 0.16), 0.7),
        // The estimate is bounded.
        ((0.05, 2.0), (0.0, 2.0), 0.3125),
        ((3.0, 1.0), (3.0, 1.0), 1.5),
    ] {
        let found = believed(before, now);
        assert!(
            (found - expected).abs() < 1e-12,
            "{before:?} {now:?}: {found}"
        );
    }
}

#[test]
fn open_loop_limits_its_squeeze_and_restarts_with_each_grasp() {
    let layout = layout();
    let mut law = law(LawConfig::named("open-loop").expect("a law"));
    let LawConfig::OpenLoop(config) = LawConfig::named("open-loop").expect("a law") else {
        panic!("the open loop")
    };
    let touch = touch(1, DVec3::ZERO);
    let mut pressing = |keep_grasp, x: f64| {
        let sense = FingerReadings {
            pose: FingertipPose {
                position: DVec3::new(x, 0.0, 0.0),
                ..FingertipPose::default()
            },
            joints: JointState::default(),
            touch: &touch,
            layout: &layout,
        };
        let plan = Plan { keep_grasp, ..MOVE };
        (law.velocity(&plan, &sense) - MOVE.velocity).x
    };
    for start in [0.02, -0.01] {
        assert_eq!(pressing(false, start), 0.0);
        assert_eq!(pressing(true, start), config.squeeze_speed);
        assert_eq!(
            pressing(true, start + 0.9 * config.squeeze),
            config.squeeze_speed
        );
        assert_eq!(pressing(true, start + 1.1 * config.squeeze), 0.0);
    }
}
