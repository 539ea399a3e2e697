//! Relaxation of feelers, compared with the closed forms of the standard linear solid.

use super::one_feeler::{OneFeeler, STEP};
use feeler_sim::contact::RelaxationConfig;
use feeler_sim::objects::MotionConfig;
use feeler_sim::shapes::shape::ShapeConfig;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const SHARE: f64 = 0.3;
const DEPTH: f64 = 0.0005;

/// A feeler with relaxation time `time` (s) in front of a fixed block at the origin.
fn before_a_block(time: f64) -> OneFeeler {
    OneFeeler::new(-0.05, |sim| {
        sim.feeler.relaxation = Some(RelaxationConfig { share: SHARE, time });
        let block = sim.object.get_mut("cap").expect("a cap");
        block.motion = MotionConfig::Fixed;
        block.shape = ShapeConfig::Box { size: [0.1; 3] };
        block.position = [0.0; 3];
    })
}

/// Rounding error of forces (N): stiffness times some mm, at positions of some cm.
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
        // Each deformation relaxes independently from its start, as the force is linear in them.
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
fn a_relaxed_feeler_responds_to_fast_motion_with_its_full_stiffness() {
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
            // Follows the feeler to keep its force constant.
            depth += (force - measured) / rig.feeler.normal_stiffness;
        }
        // The load lags by one step, and the deformation of a step counts from its end: each delays the creep by one
        // step, and its rate is `share / time` of the instantaneous deflection.
        let tolerance = 2.0 * SHARE * STEP / time;
        assert!(worst < tolerance, "{worst} with {time} s");
    }
}

/// Energy (J) that a feeler dissipates in a cycle of depth with this `amplitude` (m) and number of `steps`, measured
/// after 20 relaxation times.
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
fn a_load_cycle_dissipates_energy_by_the_loss_modulus_at_any_frequency() {
    let amplitude = 0.0001;
    for time in [0.02, 0.1, 0.4] {
        for steps in [50, 200, 1000] {
            let mut rig = before_a_block(time);
            let phase = TAU * time / (STEP * f64::from(steps));
            let loss = rig.feeler.normal_stiffness * SHARE * phase / (1.0 + phase * phase);
            let expected = PI * amplitude * amplitude * loss;
            let ratio = loop_area(&mut rig, time, amplitude, steps) / expected;
            // The set lags by half a step, which adds step / (2 time). A polygon of `steps` corners is smaller than its
            // circle by (2 pi / steps)² / 6, and the stepwise response deviates by half of that.
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
fn a_feeler_that_separates_recovers_with_the_creep_time() {
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
        // Closer than the set: no contact.
        let short = rig.press(0.9 * set - 1e-9, DVec3::ZERO);
        assert_eq!(short, DVec3::ZERO, "after {free_steps} steps");
        let set = set * (-STEP / creep_time).exp();
        let force = rig.press(DEPTH, DVec3::ZERO).x;
        let expected = rig.feeler.normal_stiffness * (DEPTH - set);
        assert!((force - expected).abs() < ROUNDING, "{force} N");
    }
}

#[test]
fn a_recovering_feeler_touches_the_object_again() {
    let mut rig = before_a_block(0.05);
    for _ in 0..2000 {
        rig.press(DEPTH, DVec3::ZERO);
    }
    // Withdrawn to half of its set, the feeler separates and recovers until it touches again; then it presses like
    // relaxed rubber.
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
