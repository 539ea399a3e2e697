//! Joint encoders that freeze, report wrong angles or jump stop the hand. Drives with lag and missed readings do not.

use super::rig::{controller_with, state, touch};
use feeler::control::{Controller, MonitorConfig, StopReason};
use feeler::hand::{HandCommand, JointVector};

const PERIOD: f64 = 0.01;

/// Encoder reading (rad), given the true angle, the initial angle and the step.
type Encoder = fn(JointVector, JointVector, usize) -> JointVector;

fn honest(now: JointVector, _: JointVector, _: usize) -> JointVector {
    now
}

/// A hand whose drives follow with a first-order lag (s), measured by an encoder.
struct Rig {
    controller: Controller,
    command: HandCommand,
    lag: f64,
    position: JointVector,
    velocity: JointVector,
    step: usize,
    stamp: f64,
}

impl Rig {
    fn new(monitor: MonitorConfig, lag: f64) -> Self {
        Self {
            controller: controller_with(monitor),
            command: HandCommand::stop(1),
            lag,
            position: state().joints[0].position,
            velocity: JointVector::default(),
            step: 0,
            stamp: 1.0,
        }
    }

    /// A control step `periods` after the previous one.
    fn step(&mut self, periods: usize, encoder: Encoder) {
        let mut seen = state();
        seen.stamp = self.stamp;
        seen.joints[0].position = encoder(self.position, state().joints[0].position, self.step);
        let mut felt = touch(self.stamp);
        felt.frame.sequence = self.step as u64;
        self.controller.decide(&[felt], &seen, &mut self.command);
        let command = self.command.joint_velocity()[0];
        for _ in 0..10 * periods {
            let part = (PERIOD / 10.0 / self.lag.max(PERIOD / 10.0)).min(1.0);
            self.velocity += part * (command - self.velocity);
            self.position += PERIOD / 10.0 * self.velocity;
        }
        self.stamp += PERIOD * periods as f64;
        self.step += 1;
    }

    /// Runs up to `steps` steps until the hand stops. Returns the reason.
    fn run(&mut self, steps: usize, encoder: Encoder) -> Option<StopReason> {
        for _ in 0..steps {
            self.step(1, encoder);
            if self.controller.stop_reason().is_some() {
                break;
            }
        }
        self.controller.stop_reason().cloned()
    }
}

fn run(encoder: Encoder) -> Option<StopReason> {
    Rig::new(MonitorConfig::default(), 0.0125).run(300, encoder)
}

/// Encoder resolution of a small drive (rad), and noise of a larger amplitude.
fn coarse(now: JointVector, _: JointVector, step: usize) -> JointVector {
    let noise = if step.is_multiple_of(2) { 5e-4 } else { -5e-4 };
    ((now + noise) / 1e-3).map(f64::round) * 1e-3
}

#[test]
fn drives_with_lag_and_coarse_encoders_are_accepted() {
    for lag in [0.0, 0.01, 0.05] {
        for encoder in [honest, coarse] {
            let mut rig = Rig::new(MonitorConfig::default(), lag);
            assert_eq!(rig.run(300, encoder), None, "{lag} s");
            // The task moves on along y and has already moved far.
            let turned = (rig.position - state().joints[0].position).abs();
            assert!(turned.max_element() > 0.1, "{turned}");
        }
    }
}

#[test]
fn a_joint_that_does_not_follow_commands_stops_the_hand() {
    let frozen: Encoder = |now, _, step| {
        if step < 100 {
            now
        } else {
            JointVector::from([0.08, now[1], now[2]])
        }
    };
    let stays: Encoder = |_, start, _| start;
    let half: Encoder = |now, start, _| start + 0.5 * (now - start);
    let reverse: Encoder = |now, start, _| start - (now - start);
    for (name, encoder) in [("stays", stays), ("half", half), ("reverse", reverse)] {
        let reason = run(encoder).unwrap_or_else(|| panic!("{name}: not stopped"));
        let StopReason::JointDeviation {
            finger: 0,
            turn,
            expected,
            time,
            ..
        } = reason
        else {
            panic!("{name}: {reason}")
        };
        assert!(
            (turn - expected).abs() > 0.015,
            "{name}: {turn}, {expected}"
        );
        assert!(time < 2.5, "{name}: {time} s");
    }
    let reason = run(frozen);
    assert!(reason.is_some(), "not stopped");
}

#[test]
fn a_joint_that_jumps_stops_the_hand_at_once() {
    let jump: Encoder = |now, _, step| {
        if step < 20 {
            now
        } else {
            now + JointVector::from([0.0, 0.1, 0.0])
        }
    };
    let mut rig = Rig::new(MonitorConfig::default(), 0.0125);
    let reason = rig.run(300, jump);
    assert_eq!(rig.step, 21);
    let Some(StopReason::JointJump {
        finger: 0,
        joint: 1,
        turn,
        limit,
        ..
    }) = reason
    else {
        panic!("{reason:?}")
    };
    // Twice 2 rad/s for 10 ms, plus 5 mrad.
    assert!((limit - 0.045).abs() < 1e-9 && (turn - 0.1).abs() < 0.01);
}

#[test]
fn an_impossible_joint_angle_stops_the_hand() {
    for angle in [1e308, -1e308, 8.0, -8.0] {
        let mut far = state();
        far.joints[0].position[2] = angle;
        let mut rig = Rig::new(MonitorConfig::default(), 0.0);
        let mut command = HandCommand::stop(1);
        command.relay(&[JointVector::splat(3, 1.0)]);
        (rig.controller).decide(&[touch(1.0)], &far, &mut command);
        let reason = rig.controller.stop_reason();
        assert!(
            matches!(
                reason,
                Some(&StopReason::JointOutOfRange {
                    finger: 0,
                    joint: 2,
                    angle: read,
                    ..
                }) if read == angle
            ),
            "{reason:?}"
        );
        assert_eq!(command.joint_velocity(), [JointVector::default()]);
    }
}

/// The fingers may be moved while the hand is stopped: monitoring restarts on resume without reporting a jump or an
/// earlier deviation.
#[test]
fn joint_monitoring_restarts_after_a_stop() {
    let mut rig = Rig::new(MonitorConfig::default(), 0.0125);
    assert_eq!(rig.run(100, honest), None);
    rig.controller.stop(StopReason::Requested {
        by: "a test".into(),
    });
    rig.step(1, honest);
    rig.position -= JointVector::splat(3, 0.2);
    rig.velocity = JointVector::default();
    rig.step(1, honest);
    rig.controller.resume();
    assert_eq!(rig.run(20, honest), None);
    let stays: Encoder = |_, start, _| start;
    rig.position = state().joints[0].position;
    rig.controller.stop(StopReason::Requested {
        by: "a test".into(),
    });
    rig.controller.resume();
    let reason = rig.run(300, stays);
    assert!(
        matches!(reason, Some(StopReason::JointDeviation { .. })),
        "{reason:?}"
    );
    // An operator may resume the hand; it never resumes automatically.
    let reason = reason.expect("a reason");
    assert!(reason.is_recoverable() && reason.is_sensor_fault() && !reason.is_stale());
}

#[test]
fn missed_periods_are_not_a_joint_fault() {
    let mut rig = Rig::new(MonitorConfig::default(), 0.0125);
    for step in 0..200 {
        let periods = [1, 1, 2, 1, 3, 1, 50][step % 7];
        rig.step(periods, honest);
        assert_eq!(rig.controller.stop_reason(), None, "step {step}");
        // Restarts away from the joint limits.
        if step % 20 == 19 {
            rig = Rig::new(MonitorConfig::default(), 0.0125);
        }
    }
}

#[test]
fn joint_checks_can_be_disabled() {
    let stays: Encoder = |_, start, _| start;
    let jump: Encoder = |now, _, step| {
        let turn = if step < 20 { 0.0 } else { 0.1 };
        now + JointVector::from([0.0, turn, 0.0])
    };
    let monitor = MonitorConfig {
        joint_deviation: 0.0,
        joint_jump: 0.0,
        ..MonitorConfig::default()
    };
    for encoder in [stays, jump] {
        assert_eq!(Rig::new(monitor, 0.0125).run(300, encoder), None);
    }
}
