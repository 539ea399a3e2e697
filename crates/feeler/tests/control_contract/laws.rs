//! The control laws beside the paper's: what each may know, and that none allocates or goes astray.

use super::rig::{Analyzers, ELEMENTS, config, controller, hand_at_home, layout, pressed, state};
use assert_no_alloc::assert_no_alloc;
use feeler::control::law::LawConfig;
use feeler::control::law::best::{Best, BestConfig};
use feeler::control::law::{Law, normal_only::NormalOnlyConfig};
use feeler::control::plan::Plan;
use feeler::control::sense::{FingerSense, FingertipPose};
use feeler::control::touch::FingerTouch;
use feeler::hand::hand::{Hand, HandCommand};
use glam::DVec3;

const MOVE: Plan = Plan {
    velocity: DVec3::new(0.0, -0.010, 0.0),
    towards_object: DVec3::X,
    reflex: true,
    keep_grasp: true,
};

/// A finger at the origin of W whose apex element, which looks along x, feels `force`.
fn touch(sequence: u64, force: DVec3) -> FingerTouch {
    let mut touch = FingerTouch::none(ELEMENTS);
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
    let sense = FingerSense {
        pose: FingertipPose::default(),
        touch: &touch,
        layout: &layout,
    };
    (law.velocity(&MOVE, &sense) - MOVE.velocity).dot(DVec3::X)
}

fn law(law: LawConfig) -> Box<dyn Law> {
    law.law(&config().control, ELEMENTS)
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
            let sense = FingerSense {
                pose: FingertipPose::default(),
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
