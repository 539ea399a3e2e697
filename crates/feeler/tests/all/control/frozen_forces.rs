//! New images with unchanging forces stop the hand.

use super::rig::{controller_with, state, touch};
use feeler::control::{Controller, MonitorConfig, StopReason};
use feeler::hand::HandCommand;
use glam::DVec3;

/// Decides on frame `sequence`, in which an element measures `force` (N) while the finger is at rest.
fn decide(controller: &mut Controller, sequence: u64, force: f64) -> Option<StopReason> {
    let stamp = 1.0 + 0.01 * sequence as f64;
    let mut touch = touch(stamp);
    touch.frame.sequence = sequence;
    touch.frame.forces[1] = DVec3::new(0.0, 0.0, force);
    let mut state = state();
    state.stamp = stamp;
    controller.decide(&[touch], &state, &mut HandCommand::stop(1));
    controller.stop_reason().cloned()
}

/// Controller without joint monitoring, because these joints do not follow commands.
fn controller(frozen_frames: u32) -> Controller {
    controller_with(MonitorConfig {
        joint_deviation: 0.0,
        frozen_frames,
        ..MonitorConfig::default()
    })
}

#[test]
fn the_tenth_frame_with_the_same_forces_stops_the_hand() {
    let mut hand = controller(10);
    for sequence in 0..20 {
        assert_eq!(
            decide(&mut hand, sequence, 0.3 + 1e-12 * sequence as f64),
            None
        );
    }
    for sequence in 20..30 {
        assert_eq!(decide(&mut hand, sequence, 0.4), None, "{sequence}");
    }
    let frozen = StopReason::StuckSensorDetector {
        finger: 0,
        frames: 10,
    };
    assert_eq!(decide(&mut hand, 30, 0.4), Some(frozen.clone()));
    assert!(frozen.is_recoverable() && !frozen.is_stale());
    // The hand is resumed: the count restarts and stops it again.
    hand.resume();
    for sequence in 31..41 {
        assert_eq!(decide(&mut hand, sequence, 0.4), None, "{sequence}");
    }
    assert_eq!(decide(&mut hand, 41, 0.4), Some(frozen));
}

#[test]
fn another_force_restarts_the_count() {
    let mut hand = controller(3);
    for sequence in 0..30 {
        let force = if sequence % 3 == 0 { 0.2 } else { 0.4 };
        assert_eq!(decide(&mut hand, sequence, force), None, "{sequence}");
    }
}

/// Repeated frames have a separate age limit, and sensors may report exactly zero if untouched.
#[test]
fn repeated_frames_and_untouched_fingers_do_not_count() {
    let mut hand = controller(3);
    for _ in 0..30 {
        assert_eq!(decide(&mut hand, 7, 0.4), None);
    }
    for sequence in 8..40 {
        assert_eq!(decide(&mut hand, sequence, 0.0), None);
    }
}

#[test]
fn the_check_can_be_disabled_for_sensors_without_noise() {
    let mut hand = controller(0);
    for sequence in 0..100 {
        assert_eq!(decide(&mut hand, sequence, 0.4), None);
    }
}
