//! The control laws beside the paper's: what each may know, and that none allocates or goes astray.

use super::rig::{Analyzers, ELEMENTS, config, controller, hand_at_home, layout, pressed, state};
use assert_no_alloc::assert_no_alloc;
use feeler::control::Plan;
use feeler::control::TactileReading;
use feeler::control::law::LawConfig;
use feeler::control::law::best::{Best, BestConfig};
use feeler::control::law::{Law, normal_only::NormalOnlyConfig};
use feeler::control::{FingerReadings, FingertipPose};
use feeler::hand::{Hand, HandCommand, JointState};
use glam::DVec3;

const MOVE: Plan = Plan {
    velocity: DVec3::new(0.0, -0.010, 0.0),
    towards_object: DVec3::X,
    reflex: true,
    keep_grasp: true,
};

/// A finger at the origin of W whose apex element, which looks along x, feels `force`.
fn touch(sequence: u64, force: DVec3) -> TactileReading {
    let mut touch = TactileReading::none(ELEMENTS);
    touch.frame.sequence = sequence;
    touch.frame.stamp = 0.01 * sequence as f64;
    touch.frame.forces[0] = force;
    touch.flags.grasp_force = force.z;
    touch.flags.largest_element = Some(0);
    touch
}

/// Speed into the object that `law` wants when its apex element feels `force`.
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
fn compression_alone_is_blind_to_shear_and_its_assumed_friction_sets_the_grasp() {
    let assumed = NormalOnlyConfig {
        friction: 0.5,
        tangential_load: 1.0,
        ..NormalOnlyConfig::default()
    };
    let mut law = law(LawConfig::NormalOnly(assumed));
    let still = pressing(&mut *law, 1, DVec3::new(0.0, 0.0, 1.5));
    let sheared = pressing(&mut *law, 2, DVec3::new(0.9, -0.4, 1.5));
    assert_eq!(still, sheared);
    // 1 N at a friction of 0.5 needs 2 N.
    assert!(still > 0.0);
    assert_eq!(pressing(&mut *law, 3, DVec3::new(0.0, 0.0, 2.0)), 0.0);
    assert!(pressing(&mut *law, 4, DVec3::new(0.0, 0.0, 2.5)) < 0.0);
}

#[test]
fn the_open_loop_feels_nothing_and_presses_its_planned_distance() {
    let mut law = law(LawConfig::named("open-loop").expect("a law"));
    let squeezing = pressing(&mut *law, 1, DVec3::new(0.0, 0.0, 0.1));
    assert_eq!(squeezing, 0.004);
    assert_eq!(pressing(&mut *law, 2, DVec3::new(3.0, 0.0, 5.0)), squeezing);
}

#[test]
fn the_best_grips_in_proportion_to_shear_before_anything_slips() {
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
    // 0.3 N of shear needs 1.5 * 0.3 / 0.5 = 0.9 N of grasp.
    let at =
        |law: &mut dyn Law, sequence, grasp| pressing(law, sequence, DVec3::new(0.3, 0.0, grasp));
    assert!(at(&mut *law, 1, 0.7) > 0.0);
    assert!(at(&mut *law, 2, 0.9).abs() < 1e-12);
    assert!(at(&mut *law, 3, 1.1) < 0.0);
    // However much shear: no element over its force, nor where a slip would bring it there.
    let much = |law: &mut dyn Law, sequence, force| pressing(law, sequence, force);
    assert!(much(&mut *law, 4, DVec3::new(1.2, 0.0, 1.76)) < 0.0);
    assert!(much(&mut *law, 5, DVec3::new(1.9, 0.0, 1.5)) < 0.0);
    assert!(much(&mut *law, 6, DVec3::new(1.2, 0.0, 1.5)) > 0.0);
}

#[test]
fn the_best_learns_the_friction_of_what_slips() {
    let layout = layout();
    for friction in [0.4, 1.2] {
        let mut law = Best::new(BestConfig::default(), ELEMENTS);
        // A sawtooth between the static limit and 0.7 of it, at 1 N, as a finger drags.
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
        // Every slip brings it 0.3 of the way; nothing else here moves it away.
        let off = (law.friction() - friction).abs();
        assert!(off < 0.01 * friction, "{} for {friction}", law.friction());
    }
}

/// Two elements of different normals share a press along the mean of these, weighted by their force.
#[test]
fn the_best_presses_along_what_it_feels_and_shares_between_elements() {
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
    // Too little to count.
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

/// Returns the law's friction estimate after an element's force changed from `before` to `now`, each `(shear, normal)` (N).
fn believed(before: (f64, f64), now: (f64, f64)) -> f64 {
    let layout = layout();
    let config = BestConfig {
        friction: 0.6,
        learning_rate: 0.5,
        ..BestConfig::default()
    };
    let mut law = Best::new(config, ELEMENTS);
    // Each frame is seen twice, as by control steps without a new one.
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
fn the_best_learns_from_slips_and_from_what_holds_harder_than_believed() {
    for (before, now, expected) in [
        // A fall of more than 0.04 N at the same force: half way from 0.6 to 0.4.
        ((0.4, 1.0), (0.3, 1.0), 0.5),
        ((0.4, 1.0), (0.37, 1.0), 0.6),
        // Less force, too: it was let go, and slipped not.
        ((0.4, 1.0), (0.3, 0.89), 0.6),
        ((0.4, 1.0), (0.3, 0.91), 0.5),
        // It holds with 0.8.
        ((0.8, 1.0), (0.8, 1.0), 0.7),
        ((0.59, 1.0), (0.8, 1.0), 0.6),
        // Too little force to tell from, in either frame.
        ((0.12, 0.14), (0.12, 0.5), 0.6),
        ((0.4, 0.5), (0.12, 0.14), 0.6),
        ((0.128, 0.16), (0.128, 0.16), 0.7),
        // Nothing is believed to be as slippery as this, or to hold so hard.
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
fn the_open_loop_presses_no_farther_than_its_distance_and_anew_in_each_grasp() {
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
