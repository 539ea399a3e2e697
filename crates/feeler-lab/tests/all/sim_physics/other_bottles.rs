//! Invariants of every physics step of runs with a seated cap and with a bottle that is loose in its holder.

use super::reference::{commands, experiment, replay, world};
use feeler_sim::objects::{Hinge, LateralConfig, Motion};
use feeler_sim::world::State;
use std::f64::consts::TAU;

#[test]
fn the_hand_turns_a_seated_cap_loose_without_upsetting_the_world() {
    let experiment = experiment(&[
        "sim.object.cap.motion.thread.seat_angle=0",
        "sim.variation.seat_angle=0",
        "task.screw.strokes=2",
        "task.screw.finger.0.stroke=[0.0, 1.0, 0.0]",
        "task.screw.finger.1.stroke=[0.0, -1.0, 0.0]",
        "task.screw.finger.0.home=[-0.038, 0.001, 0.1]",
        "task.screw.finger.1.home=[0.038, -0.001, 0.1]",
    ]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let mut angle = 0.0;
    replay(&mut world, &commands, |world, _| {
        let (cap, object) = (&world.state().objects[0], &world.model().objects[0]);
        let Motion::Turns(Hinge { thread, .. }) = &object.motion else {
            panic!("the cap is on a thread");
        };
        let fingers = world.state().fingers.iter();
        assert!(fingers.flat_map(|f| &f.forces).all(|f| f.is_finite()));
        assert!(cap.turn.torque.abs() <= thread.static_factor * thread.running_torque + 1e-8);
        // The cap only turns in the opening direction, against its running torque alone.
        let now = cap.turn.angle;
        assert!(now <= angle + 1e-4, "{now} after {angle} rad");
        angle = now;
        let descent = thread.lead * angle / TAU;
        let height = cap.pose.position.z;
        assert!((height - (object.start.position.z - descent)).abs() < 1e-15);
    });
    assert!(angle < -0.3, "{angle} rad");
}

const CLAMP: LateralConfig = LateralConfig {
    stiffness: [2e4, 5e3],
    play: [3e-4, 1e-4],
};

/// Torque on the shaft (N·m) and force on the clamp (N) at the bottle's rotation and shift.
fn held(state: &State, shaft: f64, turn_play: f64) -> (f64, [f64; 2]) {
    let beyond = |at: f64, play: f64| at.signum() * (at.abs() - play).max(0.0);
    let turn = &state.objects[0].turn;
    let sides =
        [0, 1].map(|axis| CLAMP.stiffness[axis] * beyond(turn.shift[axis], CLAMP.play[axis]));
    (shaft * beyond(turn.twist, turn_play), sides)
}

#[test]
fn forces_balance_at_every_step_of_the_reference_run_on_a_loose_bottle() {
    let turn_play = 0.02;
    let experiment = experiment(&[
        "sim.holder.turn_play=0.02",
        "sim.holder.lateral={stiffness=[2e4, 5e3], play=[3e-4, 1e-4]}",
    ]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let (mut worst_torque, mut worst_force, mut most_shift) = (0.0_f64, 0.0_f64, 0.0_f64);
    let (mut turning, mut angle) = (0, 0.0);
    replay(&mut world, &commands, |world, _| {
        let (force, torque) = world.wrench(0);
        let cap = world.state().objects[0].turn;
        let (shaft, sides) = held(
            world.state(),
            world.model().torque_sensor.stiffness,
            turn_play,
        );
        worst_torque = worst_torque.max((torque.z - cap.torque).abs());
        worst_torque = worst_torque.max((torque.z - shaft).abs());
        worst_force = worst_force.max((force.x - sides[0]).abs().max((force.y - sides[1]).abs()));
        most_shift = most_shift.max(cap.shift.length());
        turning += u32::from(cap.turning);
        angle = cap.angle;
    });
    println!(
        "{worst_torque:e} N m, {worst_force:e} N, {most_shift} m, {turning} steps, {angle} rad"
    );
    // Same tolerance as without play.
    assert!(worst_torque < 3e-9, "{worst_torque} N m");
    // The shift is balanced to 1e-11 m on feelers of some kN/m.
    assert!(worst_force < 1e-6, "{worst_force} N");
    assert!(most_shift > 1e-4 && turning > 100 && angle > 0.3);
}
