//! Feelers that relax, against the closed forms of the standard linear solid.

use super::one_feeler::{OneFeeler, STEP};
use feeler_sim::contact::RelaxationConfig;
use feeler_sim::objects::MotionConfig;
use feeler_sim::shapes::shape::ShapeConfig;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const SHARE: f64 = 0.3;
const DEPTH: f64 = 0.0005;

/// A feeler with the relaxation time `time` (s) before a fixed block about the origin.
fn before_a_block(time: f64) -> OneFeeler {
    OneFeeler::new(-0.05, |sim| {
        sim.feeler.relaxation = Some(RelaxationConfig { share: SHARE, time });
        let block = sim.object.get_mut("cap").expect("a cap");
        block.motion = MotionConfig::Fixed;
        block.shape = ShapeConfig::Box { size: [0.1; 3] };
        block.position = [0.0; 3];
    })
}

/// Forces of some N/m times some mm, with rounding of places of some cm.
const ROUNDING: f64 = 1e-12;

#[test]
fn the_force_relaxes_along_the_exponential_at_constant_deformation() {
    let time = 0.05;
    let mut rig = before_a_block(time);
    let left = |n: i32| 1.0 - SHARE * (1.0 - (-STEP * f64::from(n) / time).exp());
    let (sheared, aside) = (100, 0.0003 * DVec3::Y);
    for n in 0..600 {
        let to = if n < sheared { DVec3::ZERO } else { aside };
        let force = rig.press(DEPTH, to);
        // Each deformation relaxes by itself, from when it was made: the force is linear in them.
        let normal = rig.feeler.normal_stiffness * DEPTH * left(n);
        let shear = match n < sheared {
            true => DVec3::ZERO,
            false => rig.feeler.shear_stiffness * aside * left(n - sheared),
        };
        let error = (force - normal * DVec3::X - shear).length();
        assert!(error < ROUNDING, "{error} N in step {n}");
    }
}

#[test]
fn a_quick_motion_of_a_relaxed_feeler_meets_the_whole_stiffness() {
    let mut rig = before_a_block(0.05);
    for _ in 0..2000 {
        rig.press(DEPTH, DVec3::ZERO);
    }
    let before = rig.press(DEPTH, DVec3::ZERO);
    let quick = 1e-5 * DVec3::new(1.0, -2.0, 1.0);
    let change = rig.press(DEPTH + quick.x, quick.with_x(0.0)) - before;
    let feeler = &rig.feeler;
    let expected =
        feeler.normal_stiffness * quick.x * DVec3::X + feeler.shear_stiffness * quick.with_x(0.0);
    assert!((change - expected).length() < ROUNDING, "{change}");
}

#[test]
fn a_feeler_under_constant_force_creeps_along_the_exponential() {
    for time in [0.05, 0.2] {
        let mut rig = before_a_block(time);
        let force = 0.4;
        let at_once = force / rig.feeler.normal_stiffness;
        let mut depth = at_once;
        let creep_time = time / (1.0 - SHARE);
        let mut worst = 0.0_f64;
        for n in 0..1000 {
            let measured = rig.press(depth, DVec3::ZERO).x;
            let t = STEP * f64::from(n);
            let crept = SHARE / (1.0 - SHARE) * (1.0 - (-t / creep_time).exp());
            worst = worst.max((depth / at_once - 1.0 - crept).abs());
            // Follows the feeler so that its force stays.
            depth += (force - measured) / rig.feeler.normal_stiffness;
        }
        // The load follows a step late, and the deformation of a step counts from its end: each makes the creep
        // as much late, and it is as fast as `share / time` of what the feeler yields at once.
        let tolerance = 2.0 * SHARE * STEP / time;
        assert!(worst < tolerance, "{worst} with {time} s");
    }
}

/// Energy that a feeler takes in a cycle of depth of the given `amplitude` (m) and `steps` steps, J, after so many
/// cycles that 20 relaxation times have passed.
fn loop_area(rig: &mut OneFeeler, time: f64, amplitude: f64, steps: u32) -> f64 {
    let depth = |n: u32| DEPTH + amplitude * (TAU * f64::from(n) / f64::from(steps)).sin();
    let settling = ((20.0 * time / STEP) as u32).div_ceil(steps) * steps;
    let (mut work, mut before) = (0.0, 0.0);
    for n in 0..=settling + steps {
        let force = rig.press(depth(n), DVec3::ZERO).x;
        if n > settling {
            work += 0.5 * (before + force) * (depth(n) - depth(n - 1));
        }
        before = force;
    }
    work
}

#[test]
fn a_cycle_of_load_takes_what_the_loss_modulus_says_at_any_frequency() {
    let amplitude = 0.0001;
    for time in [0.02, 0.1, 0.4] {
        for steps in [50, 200, 1000] {
            let mut rig = before_a_block(time);
            let phase = TAU * time / (STEP * f64::from(steps));
            let loss = rig.feeler.normal_stiffness * SHARE * phase / (1.0 + phase * phase);
            let expected = PI * amplitude * amplitude * loss;
            let ratio = loop_area(&mut rig, time, amplitude, steps) / expected;
            // A set is half a step late, which adds step / (2 time). A circle of so many corners is smaller by
            // (2 pi / steps)² / 6, and what follows it in steps is off by half as much.
            let late = 1.0 + STEP / (2.0 * time);
            let coarse = (TAU / f64::from(steps)).powi(2) / 4.0;
            assert!(
                (ratio - late).abs() < coarse + (STEP / time).powi(2),
                "{ratio} with {time} s and {steps} steps"
            );
        }
    }
}

#[test]
fn a_feeler_that_lets_go_recovers_with_the_creep_time() {
    let time = 0.05;
    let creep_time = time / (1.0 - SHARE);
    for free_steps in [1, 20, 100, 1000] {
        let mut rig = before_a_block(time);
        for _ in 0..2000 {
            rig.press(DEPTH, DVec3::ZERO);
        }
        for _ in 0..free_steps {
            assert_eq!(rig.press(-0.001, DVec3::ZERO), DVec3::ZERO);
        }
        let recovered = (-STEP * f64::from(free_steps) / creep_time).exp();
        let set = SHARE * DEPTH * recovered;
        // Not as far as it is set: no touch.
        let short = rig.press(0.9 * set - 1e-9, DVec3::ZERO);
        assert_eq!(short, DVec3::ZERO, "after {free_steps} steps");
        let set = set * (-STEP / creep_time).exp();
        let force = rig.press(DEPTH, DVec3::ZERO).x;
        let expected = rig.feeler.normal_stiffness * (DEPTH - set);
        assert!((force - expected).abs() < ROUNDING, "{force} N");
    }
}

#[test]
fn a_feeler_that_recovers_comes_back_to_what_it_left() {
    let mut rig = before_a_block(0.05);
    for _ in 0..2000 {
        rig.press(DEPTH, DVec3::ZERO);
    }
    // Drawn back to half of its set it lets go, and recovers until it touches again, and presses as the
    // relaxed rubber does.
    let held = 0.5 * SHARE * DEPTH;
    assert_eq!(rig.press(held, DVec3::ZERO), DVec3::ZERO);
    let mut force = 0.0;
    for _ in 0..2000 {
        let now = rig.press(held, DVec3::ZERO).x;
        assert!(now >= force - ROUNDING, "{now} N after {force}");
        force = now;
    }
    let expected = (1.0 - SHARE) * rig.feeler.normal_stiffness * held;
    assert!((force - expected).abs() < ROUNDING, "{force} N");
}
