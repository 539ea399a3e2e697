//! Free bodies around a hand that an arm carries, and pulls at them.

use super::scene::{GRAVITY, cuboid, empty, fixed, free, run, world};
use feeler_sim::rig::{ArmMotion, ArmMotionKind, FaultConfig, FaultKind};
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::SimConfig;
use glam::DVec3;

fn travel(by: [f64; 3]) -> ArmMotion {
    ArmMotion {
        from: 0.1,
        until: 0.7,
        kind: ArmMotionKind::Travel { by },
    }
}

fn box_in(sim: &mut SimConfig, height: f64) {
    let mut body = free(cuboid(0.03, 0.03, 0.03), 0.05, 0.5);
    body.position = [0.0, 0.0, height];
    sim.object.insert("box".into(), body);
}

/// In the frame of the surroundings the arm does nothing to a body that falls freely: relative to the hand, it falls by
/// `g t² / 2` plus the way of the hand.
#[test]
fn a_falling_body_falls_past_a_hand_that_rises() {
    let mut sim = empty();
    sim.arm = vec![travel([0.02, 0.0, 0.1])];
    box_in(&mut sim, 0.0);
    let mut world = world(&sim);
    let time = 0.8;
    run(&mut world, time);
    let fall = -world.state().objects[0].pose.position;
    let expected = DVec3::new(0.02, 0.0, 0.1 + 0.5 * GRAVITY * time * (time + sim.step));
    // Symplectic Euler errs by about the step squared times the largest acceleration of the hand, 1e-6 s² · 1.6 m/s².
    assert!(
        fall.distance(expected) < 2e-6,
        "expected {expected} m, got {fall} m"
    );
}

#[test]
fn a_box_stays_on_its_table_while_the_hand_rises() {
    let mut sim = empty();
    sim.arm = vec![travel([0.0, 0.0, 0.1])];
    sim.object
        .insert("table".into(), fixed(ShapeConfig::HalfSpace));
    box_in(&mut sim, 0.015);
    let mut world = world(&sim);
    for _ in 0..10 {
        run(&mut world, 0.08);
        let [first, second] = [0, 1].map(|index| world.state().objects[index].pose.position.z);
        // Contacts with moving bodies are soft, with a natural frequency of 30 Hz: a box at rest sinks by up to
        // g / (2 pi 30 Hz)² = 0.28 mm.
        assert!(
            (first - second - 0.015).abs() < 2.8e-4,
            "{}",
            first - second
        );
    }
    let table = world.state().objects[1].pose.position.z;
    assert!((table + 0.1).abs() < 1e-12, "the table is at {table} m");
}

/// A box of mass m under the force F moves by `F t² / 2 m`; half of it while the force rises takes a sixth of that.
#[test]
fn a_pull_accelerates_a_body() {
    let mut sim = empty();
    sim.gravity = [0.0; 3];
    box_in(&mut sim, 0.0);
    let over = 0.2;
    sim.fault = vec![FaultConfig {
        kind: FaultKind::Pull {
            object: "box".into(),
            force: [0.0, 0.1, 0.0],
            over,
        },
        from: 0.0,
        until: None,
    }];
    let mut world = world(&sim);
    run(&mut world, over);
    let moved = world.state().objects[0].pose.position;
    let expected = 0.1 / 0.05 * over * over / 6.0;
    // A step of 1 ms of 0.2 s.
    assert!((moved.y / expected - 1.0).abs() < 0.02, "{moved}");
    assert_eq!((moved.x, moved.z), (0.0, 0.0));
}
