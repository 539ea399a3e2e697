//! Energy balance of closed load cycles.

use super::scene::{empty, fixed, world_with_fingers};
use feeler_sim::contact::RelaxationConfig;
use feeler_sim::objects::Pose;
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use glam::{DMat3, DVec3, EulerRot};
use std::f64::consts::TAU;

const RADIUS: f64 = 0.014;

/// A fixed cylinder at the origin, for feelers of any kind.
fn cylinder() -> SimConfig {
    let mut sim = empty();
    let shape = ShapeConfig::Cylinder {
        radius: RADIUS,
        height: 0.04,
    };
    sim.object.insert("cylinder".into(), fixed(shape));
    sim
}

/// Pose of the fingertip at phase `cycle` (0 to 1): compressed by about 2 mm, with motion in all six degrees of
/// freedom, and closed.
fn pose(cycle: f64, size: f64) -> Pose {
    let wave = |n: f64| size * (TAU * n * cycle).sin();
    let push = 0.0015 + 0.0005 * size * (1.0 - (TAU * cycle).cos());
    let aside = 0.001 * DVec3::new(0.0, wave(1.0), wave(2.0));
    let (yaw, pitch, roll) = (0.03 * wave(1.0), 0.03 * wave(2.0), 0.02 * wave(3.0));
    let facing = DMat3::from_cols(DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z);
    Pose {
        position: (RADIUS + 0.0195 - push) * DVec3::X + aside,
        rotation: DMat3::from_euler(EulerRot::ZYX, yaw, pitch, roll) * facing,
    }
}

/// Force (N) and torque about the dome's centre (N·m) on the object, in W.
fn wrench(world: &World, centre: DVec3) -> (DVec3, DVec3) {
    let (force, torque) = world.wrench(0);
    (force, torque - centre.cross(force))
}

/// Work (J) done by the finger in a cycle of `size`, after one initial cycle.
fn work(sim: &SimConfig, size: f64, steps: u32) -> f64 {
    let mut world = world_with_fingers(sim, 1);
    // Straight approach.
    for n in 0..=100 {
        let mut start = pose(0.0, size);
        start.position.x += 0.002 * (1.0 - f64::from(n) / 100.0);
        world.hold_fingertip(0, Some(start));
        world.step().expect("a step");
    }
    let (mut work, mut before) = (0.0, pose(0.0, size));
    let (mut force, mut torque) = wrench(&world, before.position);
    for n in 1..=2 * steps {
        let now = pose(f64::from(n) / f64::from(steps), size);
        world.hold_fingertip(0, Some(now));
        world.step().expect("a step");
        let (new_force, new_torque) = wrench(&world, now.position);
        if n > steps {
            work += 0.5 * (force + new_force).dot(now.position - before.position);
            work += 0.5 * (torque + new_torque).dot(now.turn_since(&before.rotation));
        }
        (force, torque, before) = (new_force, new_torque, now);
    }
    work
}

/// Approximate energy (J) stored in the springs of the pressed fingertip: some 6 N over 2 mm.
const STORED: f64 = 5e-3;

#[test]
fn sticking_feelers_return_all_work_of_a_cycle() {
    for (coupling, limit) in [
        (0.0, None),
        (300.0, None),
        (0.0, Some(0.0012)),
        (200.0, Some(0.001)),
    ] {
        let mut sim = cylinder();
        (sim.feeler.static_friction, sim.feeler.kinetic_friction) = (1e6, 1e6);
        sim.feeler.normal_shear_coupling = coupling;
        sim.feeler.length_limit = limit;
        // The trapezoidal rule over waves of up to three per cycle has an error of (3 * 2 pi / 1000)^2 / 12 = 3e-5 of
        // the exchanged energy, which is about a tenth of the stored energy.
        let lost = work(&sim, 0.1, 1000) / STORED;
        assert!(
            lost.abs() < 3e-6,
            "{lost} with coupling {coupling} and length limit {limit:?}"
        );
    }
}

#[test]
fn slipping_or_damped_feelers_dissipate_energy() {
    for (friction, damping) in [(0.2, 0.0), (0.6, 0.0), (1.0, 0.0), (1.0, 0.5)] {
        let mut sim = cylinder();
        sim.feeler.static_friction = friction;
        sim.feeler.kinetic_friction = 0.7 * friction;
        (sim.feeler.normal_damping, sim.feeler.shear_damping) = (damping, damping);
        let lost = work(&sim, 1.0, 1000) / STORED;
        assert!(
            lost > 0.5,
            "{lost} with friction {friction} and damping {damping}"
        );
    }
}

#[test]
fn relaxing_feelers_dissipate_energy_at_any_load_rate() {
    for time in [0.002, 0.02, 0.2, 2.0] {
        for (coupling, limit) in [(0.0, None), (300.0, Some(0.001))] {
            let mut sim = cylinder();
            (sim.feeler.static_friction, sim.feeler.kinetic_friction) = (1e6, 1e6);
            sim.feeler.normal_shear_coupling = coupling;
            sim.feeler.length_limit = limit;
            let share = 0.3;
            let elastic = work(&sim, 0.3, 1000);
            sim.feeler.relaxation = Some(RelaxationConfig { share, time });
            let lost = work(&sim, 0.3, 1000);
            assert!(lost > elastic.max(0.0), "{lost} J with {time} s");
        }
    }
}
