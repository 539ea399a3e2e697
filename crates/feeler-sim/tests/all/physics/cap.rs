//! Cap on its thread: descent, tightening and loosening.

use feeler_sim::objects::{FingerLoad, Hinge, PlaySpring, Pose, ThreadConfig, Turn};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

const CAP: Hinge = Hinge {
    thread: ThreadConfig {
        running_torque: 0.0025,
        seat_angle: 0.46,
        seat_stiffness: 0.9,
        static_factor: 1.05,
        lead: 0.00318,
        fault: None,
    },
    on_torque_sensor: true,
};
const START: Pose = Pose {
    position: DVec3::new(0.0, 0.0, 0.1),
    rotation: DMat3::IDENTITY,
};
const SHAFT: f64 = 50.0;

#[test]
fn the_cap_descends_by_its_lead_per_turn() {
    for angle in [0.0, 0.46, TAU, -TAU] {
        let state = Turn {
            angle,
            ..Turn::default()
        };
        let expected = 0.1 - 0.00318 * angle / TAU;
        // Rounding of numbers of about 0.1.
        assert!((CAP.pose(&state, &START).position.z - expected).abs() < 1e-16);
    }
}

/// Turns the far end of a torsion spring (`stiffness`, N·m/rad) to `to` (rad) and then to `-to`.
///
/// Returns the work done by the drive (J) and the cap's final state.
fn close_and_open(stiffness: f64, to: f64) -> (f64, Turn) {
    let (mut cap, mut work, mut drive) = (Turn::default(), 0.0, 0.0);
    let steps = 4000;
    for n in 1..=2 * steps {
        let share = f64::from(n) / f64::from(steps);
        let target = if n <= steps {
            to * share
        } else {
            to * (3.0 - 2.0 * share)
        };
        let before = cap.torque;
        CAP.turn(
            &mut cap,
            (0.0, 0.0),
            &PlaySpring::new(SHAFT, 0.0),
            |state| FingerLoad {
                load: stiffness * (target - state.angle - state.twist),
                stiffness,
                firm: stiffness,
                room: f64::INFINITY,
            },
        );
        assert!(cap.angle.is_finite() && cap.torque.is_finite());
        // Stuck below the breakaway torque, or turning at the resisting one.
        let breakaway = CAP.thread.static_factor * CAP.thread.resisting_torque(cap.angle);
        assert!(cap.torque.abs() <= breakaway + 1e-8, "{cap:?}");
        // The energy stored in the spring follows from its torque; the rest went into the cap.
        work += 0.5 * (before + cap.torque) * (target - drive);
        drive = target;
    }
    (work, cap)
}

#[test]
fn a_tightened_cap_comes_loose_and_gives_back_no_energy() {
    // Springs softer and stiffer than the seat; with the soft one the cap snaps loose.
    for stiffness in [0.3, 0.9, 3.0] {
        let (work, cap) = close_and_open(stiffness, 0.8);
        assert!(work > 0.0, "the cap returned {work} J");
        // A loose cap follows the spring: its torque is the running torque against the motion.
        assert!(
            (cap.torque + CAP.thread.running_torque).abs() < 2e-4,
            "{cap:?}"
        );
        assert!(cap.angle < 0.0, "{cap:?}");
    }
}
