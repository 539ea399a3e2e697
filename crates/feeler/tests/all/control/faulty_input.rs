//! Input that is NaN or infinite, in any field, or of another number of joints stops the hand.

use super::rig::{controller, state, touch};
use feeler::control::{StopReason, TactileReading};
use feeler::hand::{HandCommand, HandState, JointVector};

/// Reason for which the hand stops at this input, and the commanded velocity.
fn decided(touch: &TactileReading, state: &HandState) -> (Option<StopReason>, JointVector) {
    let mut controller = controller();
    let mut command = HandCommand::stop(1);
    // Makes a command that is left unchanged differ from a stop.
    command.relay(&[JointVector::splat(3, 1.0)]);
    controller.decide(std::slice::from_ref(touch), state, &mut command);
    let stopped = controller.stop_reason().cloned();
    (stopped, command.joint_velocity()[0])
}

#[test]
fn a_finger_with_valid_input_moves() {
    let (stopped, velocity) = decided(&touch(1.0), &state());
    assert_eq!(stopped, None);
    assert!(velocity != JointVector::default());
}

#[test]
fn non_finite_input_stops_the_hand_in_every_field() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut angle = state();
            angle.joints[0].position[axis] = wrong;
            let mut speed = state();
            speed.joints[0].velocity[axis] = wrong;
            let mut force = touch(1.0);
            force.frame.forces[2][axis] = wrong;
            let finger = 0;
            let not_finite = |what| StopReason::NotFinite { finger, what };
            // NaN marks an invalid force.
            let no_force = match wrong.is_nan() {
                true => StopReason::NoForce { finger, element: 2 },
                false => not_finite("force"),
            };
            for (touch, state, reason) in [
                (touch(1.0), angle, not_finite("joint state")),
                (touch(1.0), speed, not_finite("joint state")),
                (force, state(), no_force),
            ] {
                let (stopped, velocity) = decided(&touch, &state);
                assert_eq!(stopped, Some(reason), "{wrong} along {axis}");
                assert_eq!(velocity, JointVector::default());
            }
        }
    }
}

#[test]
fn forces_beyond_the_age_limit_or_from_the_future_are_stale() {
    // 3.5 periods of 10 ms, with a margin of one microsecond for rounding.
    for (stamp, good) in [
        (1.0 - 0.034_999, true),
        (1.0 - 0.035_001, false),
        (1.0 + 0.034_999, true),
        (1.0 + 0.035_001, false),
        (f64::NAN, false),
    ] {
        let (stopped, _) = decided(&touch(stamp), &state());
        let stale = matches!(stopped, Some(StopReason::StaleForces { finger: 0, .. }));
        assert_eq!(stale, !good, "{stamp}: {stopped:?}");
        assert_eq!(stopped.is_none(), good, "{stamp}: {stopped:?}");
    }
}

#[test]
fn a_force_above_the_limit_of_an_element_stops_the_hand() {
    for (force, good) in [(4.0, true), (4.000_1, false), (-9.0, true)] {
        let mut touch = touch(1.0);
        touch.frame.forces[1].z = force;
        let (stopped, _) = decided(&touch, &state());
        let expected = (!good).then_some(StopReason::Overload {
            finger: 0,
            element: 1,
            force,
            limit: 4.0,
        });
        assert_eq!(stopped, expected);
    }
}

#[test]
fn another_number_of_joints_stops_the_hand() {
    for actual in [1, 2, 4, 7] {
        let (mut angles, mut speeds) = (state(), state());
        angles.joints[0].position = JointVector::zeros(actual);
        speeds.joints[0].velocity = JointVector::zeros(actual);
        for state in [angles, speeds] {
            let (stopped, velocity) = decided(&touch(1.0), &state);
            let (finger, expected) = (0, 3);
            let reason = StopReason::JointCount {
                finger,
                expected,
                actual,
            };
            assert_eq!(stopped, Some(reason));
            assert_eq!(velocity, JointVector::default());
        }
    }
}
