//! Sensors that fail, stall or repeat data: the hand stops within one period and reports the reason.

use super::hand::IdealHand;
use super::rig::{Analyzers, ELEMENTS, config, controller, hand_at_home, pressed, state};
use feeler::control::{ControlError, ControlLoop, FlaggedSensor, Phase, StopReason};
use feeler::hand::{HandCommand, HandState, JointVector};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};

#[derive(Clone, Copy)]
enum Fault {
    /// Reads fail from this frame on.
    Fails(u64),
    /// All reads from this frame on return the same frame.
    Stalls(u64),
    /// All reads from this frame on return the same image with new stamps.
    Repeats(u64),
    None,
}

struct Sensor {
    fault: Fault,
    frames: u64,
}

impl TactileSensor for Sensor {
    fn element_count(&self) -> usize {
        ELEMENTS
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let now = self.frames;
        self.frames += 1;
        let (sequence, stamp) = match self.fault {
            Fault::Fails(at) if now >= at => return Err(SensorError::Ended { count: now }),
            Fault::Stalls(at) => (now.min(at), now.min(at)),
            Fault::Repeats(at) => (now.min(at), now),
            _ => (now, now),
        };
        reading.sequence = sequence;
        reading.stamp = 0.01 * stamp as f64;
        Ok(())
    }
}

type Loop = ControlLoop<FlaggedSensor<Sensor>, IdealHand>;

/// A searching hand after `periods`, whose finger 1 has `fault`.
fn run(fault: Fault, periods: usize) -> (Result<(), ControlError>, Loop) {
    let mut config = config();
    // Between two periods, so that rounding does not matter.
    config.control.stale_periods = 3.5;
    let sensors = [Fault::None, fault].map(|fault| Sensor { fault, frames: 0 });
    let sensors = sensors.map(|s| FlaggedSensor::new(s, config.control.thresholds()));
    let hand = hand_at_home(&config);
    let mut control_loop = ControlLoop::new(sensors.into(), hand, controller(&config));
    let result = (0..periods).try_for_each(|_| control_loop.step());
    (result, control_loop)
}

#[test]
fn a_failing_sensor_stops_the_hand_and_is_reported() {
    let (result, mut control_loop) = run(Fault::Fails(20), 20);
    assert!(result.is_ok());
    assert_ne!(*control_loop.command(), HandCommand::stop(2));
    let error = control_loop.step();
    assert!(
        matches!(
            error,
            Err(ControlError::Sensor {
                finger: 1,
                source: SensorError::Ended { count: 20 }
            })
        ),
        "{error:?}"
    );
    assert_eq!(*control_loop.command(), HandCommand::stop(2));
    // The hand has executed the stop: its joints are at rest.
    assert!(control_loop.step().is_err());
    let joints = &control_loop.state().joints;
    assert!(
        joints.iter().all(|j| j.velocity == JointVector::default()),
        "{joints:?}"
    );
}

#[test]
fn stale_forces_stop_both_fingers_within_one_period() {
    for fault in [Fault::Stalls(20), Fault::Repeats(20)] {
        // Frame 20 is 3 periods old at period 23 and 4 periods old at period 24; the limit is 3.5.
        let (_, before) = run(fault, 24);
        assert_eq!(before.controller().stop_reason(), None);
        assert!(
            before
                .command()
                .joint_velocity()
                .iter()
                .all(|v| *v != JointVector::default())
        );
        let (_, after) = run(fault, 25);
        assert_eq!(*after.command(), HandCommand::stop(2));
        assert_eq!(after.controller().phase(), Phase::Stopped);
        let Some(&StopReason::StaleForces {
            finger: 1,
            age,
            limit,
        }) = after.controller().stop_reason()
        else {
            panic!("{:?}", after.controller().stop_reason())
        };
        assert!((age - 0.04).abs() < 1e-12 && (limit - 0.035).abs() < 1e-12);
    }
}

/// Reason for which the reference controller stops at this input, and its command.
fn decide(frames: &[TactileFrame], state: &HandState) -> (Option<StopReason>, HandCommand) {
    let config = config();
    let mut controller = controller(&config);
    let touches = Analyzers::new(&config).touches(frames);
    let mut command = HandCommand::stop(2);
    command.relay(&[JointVector::splat(3, 1.0); 2]);
    controller.decide(&touches, state, &mut command);
    (controller.stop_reason().cloned(), command)
}

fn at_home() -> HandState {
    state(&hand_at_home(&config()))
}

#[test]
fn each_fault_has_a_reason_and_stops_both_fingers() {
    let good = || vec![pressed(0, 0.0, 0.0); 2];
    let mut cases = vec![];
    let mut broken = good();
    broken[0].forces[7].y = f64::NAN;
    cases.push((
        broken,
        at_home(),
        StopReason::NoForce {
            finger: 0,
            element: 7,
        },
    ));
    let mut broken = good();
    broken[0].forces[7].y = f64::INFINITY;
    let what = "force";
    let reason = StopReason::NotFinite { finger: 0, what };
    cases.push((broken, at_home(), reason));
    let mut infinite = at_home();
    infinite.joints[1].position[2] = f64::INFINITY;
    cases.push((
        good(),
        infinite,
        StopReason::NotFinite {
            finger: 1,
            what: "joint state",
        },
    ));
    let (what, expected) = ("tactile frames", 2);
    cases.push((
        vec![pressed(0, 0.0, 0.0)],
        at_home(),
        StopReason::FingerCount {
            what,
            expected,
            actual: 1,
        },
    ));
    let mut one = at_home();
    one.joints.pop();
    let what = "joint states";
    cases.push((
        good(),
        one,
        StopReason::FingerCount {
            what,
            expected,
            actual: 1,
        },
    ));
    let mut short = good();
    short[1].forces.pop();
    let reason = StopReason::ElementCount {
        finger: 1,
        expected: ELEMENTS,
        actual: 40,
    };
    cases.push((short, at_home(), reason));
    let limit = config().control.stale_periods * config().control.period;
    let too_old = limit + 1e-3;
    for stamp in [f64::NEG_INFINITY, -too_old, too_old, f64::INFINITY] {
        let mut late = good();
        late[0].stamp = stamp;
        let reason = StopReason::StaleForces {
            finger: 0,
            age: -stamp,
            limit,
        };
        cases.push((late, at_home(), reason));
    }
    for (frames, state, reason) in cases {
        let (stopped, command) = decide(&frames, &state);
        assert_eq!(stopped.as_ref(), Some(&reason));
        assert_eq!(command, HandCommand::stop(2), "{reason}");
    }
    let mut timeless = good();
    timeless[1].stamp = f64::NAN;
    let (stopped, command) = decide(&timeless, &at_home());
    assert!(matches!(
        stopped,
        Some(StopReason::StaleForces { finger: 1, .. })
    ));
    assert_eq!(command, HandCommand::stop(2));
    assert_eq!(decide(&good(), &at_home()).0, None);
}

#[test]
fn the_first_reason_is_kept_and_the_hand_stays_stopped() {
    let config = config();
    let mut controller = controller(&config);
    let mut analyzers = Analyzers::new(&config);
    let mut command = HandCommand::stop(2);
    controller.decide(&[], &at_home(), &mut command);
    let reason = controller.stop_reason().cloned();
    for n in 0..10 {
        let mut frames = vec![pressed(n, 0.0, 0.3); 2];
        frames[0].forces[0].x = if n == 5 { f64::NAN } else { 0.5 * n as f64 };
        let touches = analyzers.touches(&frames);
        controller.decide(&touches, &at_home(), &mut command);
        assert_eq!(command, HandCommand::stop(2));
        assert_eq!(controller.stop_reason().cloned(), reason);
    }
}

#[test]
fn a_resumed_hand_stops_again_while_the_cause_persists() {
    let config = config();
    let (mut controller, mut analyzers) = (controller(&config), Analyzers::new(&config));
    let mut command = HandCommand::stop(2);
    let good = |n| vec![pressed(n, 0.0, 0.0); 2];
    let mut broken = good(1);
    broken[0].forces[0].x = f64::NAN;
    controller.decide(&analyzers.touches(&broken), &at_home(), &mut command);
    assert_eq!(controller.phase(), Phase::Stopped);

    controller.resume();
    assert_eq!(controller.stop_reason(), None);
    controller.decide(&analyzers.touches(&broken), &at_home(), &mut command);
    assert_eq!(controller.phase(), Phase::Stopped);
    assert_eq!(command, HandCommand::stop(2));

    controller.resume();
    controller.decide(&analyzers.touches(&good(3)), &at_home(), &mut command);
    assert_eq!(controller.phase(), Phase::Search);
    let velocities = command.joint_velocity();
    assert!(
        velocities.iter().all(|v| *v != JointVector::default()),
        "{command:?}"
    );
}
