//! The cap on its thread: descent, and turning it loose again.

use super::reference::{commands, experiment, replay, world};
use feeler::sim::cap::{CapConfig, CapState, Grip};
use std::f64::consts::TAU;

const CAP: CapConfig = CapConfig {
    radius: 0.014,
    height: 0.02,
    position: [0.0, 0.0, 0.1],
    running_torque: 0.0025,
    seat_angle: 0.46,
    seat_stiffness: 0.9,
    static_factor: 1.05,
    lead: 0.00318,
};
const SHAFT: f64 = 50.0;

#[test]
fn the_cap_descends_by_its_lead_per_turn() {
    for angle in [0.0, 0.46, TAU, -TAU] {
        let state = CapState {
            angle,
            ..CapState::default()
        };
        let expected = 0.1 - 0.00318 * angle / TAU;
        // Rounding of numbers of about 0.1.
        assert!((CAP.pose(&state, 1.2).centre.z - expected).abs() < 1e-16);
    }
}

/// Turns the far end of a torsion spring (`stiffness`, N·m/rad) to `to` (rad) and then back past 0
/// by as much; the work put in, N·m·rad, and the cap in the end.
fn close_and_open(stiffness: f64, to: f64) -> (f64, CapState) {
    let (mut cap, mut work, mut drive) = (CapState::default(), 0.0, 0.0);
    let steps = 4000;
    for n in 1..=2 * steps {
        let share = f64::from(n) / f64::from(steps);
        let target = if n <= steps {
            to * share
        } else {
            to * (3.0 - 2.0 * share)
        };
        let before = cap.torque;
        CAP.turn(&mut cap, SHAFT, |state| Grip {
            torque: stiffness * (target - state.angle - state.twist),
            stiffness,
        });
        assert!(cap.angle.is_finite() && cap.torque.is_finite());
        // Stuck below the breakaway torque, or turning at the resisting one.
        let breakaway = CAP.static_factor * CAP.resisting_torque(cap.angle);
        assert!(cap.torque.abs() <= breakaway + 1e-8, "{cap:?}");
        // The spring's own energy is what its torque says; the rest went through the cap.
        work += 0.5 * (before + cap.torque) * (target - drive);
        drive = target;
    }
    (work, cap)
}

#[test]
fn a_tightened_cap_comes_loose_and_gives_back_no_energy() {
    // Softer and stiffer than the seat: the softer one snaps loose.
    for stiffness in [0.3, 0.9, 3.0] {
        let (work, cap) = close_and_open(stiffness, 0.8);
        assert!(work > 0.0, "{work} J came out of the cap");
        // Loose, it follows the spring: torque is the running torque against the motion.
        assert!((cap.torque + CAP.running_torque).abs() < 2e-4, "{cap:?}");
        assert!(cap.angle < 0.0, "{cap:?}");
    }
}

#[test]
fn the_hand_turns_a_seated_cap_loose_without_upsetting_the_world() {
    let experiment = experiment(&[
        "sim.cap.seat_angle=0",
        "sim.variation.seat_angle=0",
        "task.strokes=2",
        "task.finger.0.stroke=[0.0, 1.0, 0.0]",
        "task.finger.1.stroke=[0.0, -1.0, 0.0]",
        "task.finger.0.home=[-0.038, 0.001, 0.1]",
        "task.finger.1.home=[0.038, -0.001, 0.1]",
    ]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let mut angle = 0.0;
    replay(&mut world, &commands, |world, _| {
        let (cap, model) = (world.state().cap, world.model());
        let fingers = world.state().fingers.iter();
        assert!(fingers.flat_map(|f| &f.forces).all(|f| f.is_finite()));
        assert!(cap.torque.abs() <= model.cap.static_factor * model.cap.running_torque + 1e-8);
        // Turned one way only: it comes up, and meets nothing but its running torque.
        assert!(cap.angle <= angle + 1e-4, "{} after {angle} rad", cap.angle);
        angle = cap.angle;
        let descent = model.cap.lead * cap.angle / TAU;
        let height = world.state().cap_pose.centre.z;
        assert!((height - (model.cap.position[2] - descent)).abs() < 1e-15);
    });
    assert!(angle < -0.3, "{angle} rad");
}
