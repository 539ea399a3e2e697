//! Efforts of the drives that contradict the tactile sensor stop the hand.

use super::rig::{controller_of, controller_with, geometry, home, layout, state, touch};
use feeler::control::{Controller, MonitorConfig, StopReason, TactileReading};
use feeler::hand::{
    HandCommand, HandState, JointCoupling, JointEfforts, JointVector, fingertip_pose,
};
use glam::DVec3;

/// Force on the apex by the object (N, in W): along and across the dome's axis.
const FORCE: DVec3 = DVec3::new(-1.2, 0.3, 0.5);

/// Controller without the other monitors: these joints do not follow commands, and the forces have no noise.
fn controller(effort_share: f64) -> Controller {
    controller_with(quiet(effort_share))
}

/// Monitors of efforts only.
fn quiet(effort_share: f64) -> MonitorConfig {
    MonitorConfig {
        joint_deviation: 0.0,
        frozen_frames: 0,
        effort_share,
        ..MonitorConfig::default()
    }
}

/// Reading of a sensor that measures `gain` times [`FORCE`] at `stamp` (s).
fn pressed(gain: f64, stamp: f64, sequence: u32) -> TactileReading {
    let rotation = fingertip_pose(&geometry(), home()).1;
    // The apex's axes in the fingertip's frame; compression is positive.
    let (apex, force) = (layout().elements[0], rotation.transpose() * FORCE);
    let axes = DVec3::AXES.map(|axis| apex.force_on_fingertip(axis).dot(force));
    let mut touch = touch(stamp);
    touch.frame.sequence = sequence.into();
    touch.frame.forces[0] = gain * DVec3::from_array(axes);
    touch
}

/// Torques that balance [`FORCE`] at the dome's centre, from finite differences of its position (N m): the power of the
/// motors and of the force cancel.
fn balance() -> JointVector {
    const STEP: f64 = 1e-6;
    let mut torques = JointVector::zeros(3);
    for joint in 0..3 {
        let at = |step: f64| {
            let mut theta = home();
            theta[joint] += step;
            fingertip_pose(&geometry(), theta).0
        };
        let column = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        torques[joint] = -column.dot(FORCE);
    }
    torques
}

/// Runs for a second with motors that balance [`FORCE`], known to an `uncertainty` (N m), and a sensor that measures `gain`
/// times the force. Returns the reason for which the hand stopped, and the time at which it did (s).
fn run(
    controller: &mut Controller,
    gain: f64,
    effort: JointVector,
    uncertainty: f64,
) -> Option<(StopReason, f64)> {
    for step in 0..100_u32 {
        let time = 0.01 * f64::from(step);
        let (mut state, touch) = (state(), pressed(gain, 1.0 + time, step));
        state.stamp = 1.0 + time;
        // Noise of currents.
        let noise = if step % 2 == 0 { 1.05 } else { 0.95 };
        state.efforts = vec![JointEfforts {
            effort: effort.map(|effort| noise * effort),
            uncertainty: JointVector::splat(3, uncertainty),
        }];
        controller.decide(&[touch], &state, &mut HandCommand::stop(1));
        if let Some(reason) = controller.stop_reason() {
            return Some((reason.clone(), time));
        }
    }
    None
}

#[test]
fn agreeing_efforts_do_not_stop_the_hand() {
    for gain in [0.75, 1.0, 1.35] {
        assert_eq!(run(&mut controller(0.3), gain, balance(), 1e-3), None);
    }
}

#[test]
fn a_numb_sensor_and_one_of_twice_the_gain_stop_the_hand() {
    for gain in [0.0, 2.0] {
        let mut hand = controller(0.3);
        let (reason, time) = run(&mut hand, gain, balance(), 1e-3).expect("a stop");
        let StopReason::EffortMismatch {
            joint,
            effort,
            felt,
            ..
        } = reason
        else {
            panic!("{reason}");
        };
        assert!(
            (effort / balance()[joint] - 1.0).abs() < 0.05,
            "{effort} N m"
        );
        assert!((felt - gain * balance()[joint]).abs() < 1e-6, "{felt} N m");
        assert!((0.1..0.2).contains(&time), "{time} s");
        assert!(reason.is_sensor_fault() && reason.is_recoverable());
        // The hand is resumed: it stops again only after the same time.
        hand.resume();
        let (_, again) = run(&mut hand, gain, balance(), 1e-3).expect("a stop");
        assert!((0.1..0.2).contains(&again), "{again} s");
    }
}

#[test]
fn uncertain_unknown_and_missing_efforts_are_not_compared() {
    assert_eq!(run(&mut controller(0.3), 0.0, balance(), 1.0), None);
    assert_eq!(run(&mut controller(0.0), 0.0, balance(), 1e-3), None);
    let unknown = JointVector::splat(3, f64::NAN);
    assert_eq!(run(&mut controller(0.3), 0.0, unknown, 1e-3), None);
    assert_eq!(
        run(&mut controller(0.3), 0.0, JointVector::default(), 1e-3),
        None
    );
}

/// Two fingers whose joints 1 are moved by one motor, the second at half the speed, with sensors of these gains. Returns
/// the reason for which the hand stopped.
fn run_coupled(gains: [f64; 2], effort: f64) -> Option<StopReason> {
    let mut controller = controller_of(2, quiet(0.3));
    controller.set_couplings(vec![JointCoupling {
        first: (0, 1),
        other: (1, 1),
        ratio: 0.5,
    }]);
    for step in 0..100_u32 {
        let time = 1.0 + 0.01 * f64::from(step);
        let mut state = HandState {
            stamp: time,
            joints: vec![state().joints[0]; 2],
            efforts: vec![JointEfforts::default(); 2],
        };
        let mut known = JointVector::splat(3, f64::NAN);
        known[1] = effort;
        state.efforts[0] = JointEfforts {
            effort: known,
            uncertainty: JointVector::splat(3, 1e-3),
        };
        let touches = gains.map(|gain| pressed(gain, time, step));
        controller.decide(&touches, &state, &mut HandCommand::stop(2));
        if let Some(reason) = controller.stop_reason() {
            return Some(reason.clone());
        }
    }
    None
}

/// By virtual work, the motor balances the force on finger 0 and half of that on finger 1.
#[test]
fn a_motor_of_two_fingers_balances_the_sum_of_their_forces() {
    let sum = 1.5 * balance()[1];
    assert_eq!(run_coupled([1.0, 1.0], sum), None);
    // The forces may differ between the fingers.
    assert_eq!(run_coupled([1.4, 0.2], sum), None);
    for (gains, effort) in [
        ([1.0, 0.0], sum),
        ([0.0, 1.0], sum),
        ([2.0, 2.0], sum),
        ([1.0, 1.0], balance()[1] / 2.0),
    ] {
        let reason = run_coupled(gains, effort).expect("a stop");
        let text = reason.to_string();
        let StopReason::EffortMismatch { finger, felt, .. } = reason else {
            panic!("{text}");
        };
        let expected = (gains[0] + 0.5 * gains[1]) * balance()[1];
        assert_eq!(finger, 0);
        assert!((felt - expected).abs() < 1e-9, "{felt}, {expected}");
        assert!(text.contains("all fingertips that it moves"), "{text}");
    }
}
