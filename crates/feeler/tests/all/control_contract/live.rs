//! Background sensors and steps that follow their images. The outcome does not depend on the computer's speed: a test
//! proceeds when a sensor's thread requests the next reading, so the previous one has been processed.

use super::hand::IdealHand;
use super::rig::{ELEMENTS, config, controller, hand_at_home, pressed};
use assert_no_alloc::assert_no_alloc;
use feeler::control::{
    BackgroundSensor, ControlLoop, FlagThresholds, NewDataSignal, StopReason, TactileReading,
    TactileSource, live,
};
use feeler::pace::{DataDriven, StepTrigger};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::image::CameraError;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

type Reading = Result<TactileFrame, SensorError>;

/// A sensor that returns the readings given by the test and reports each request.
struct Given {
    asks: Sender<()>,
    given: Receiver<Reading>,
}

impl TactileSensor for Given {
    fn element_count(&self) -> usize {
        ELEMENTS
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        // After the test has ended, there is no receiver.
        let _ = self.asks.send(());
        let given = self.given.recv();
        let frame = given.unwrap_or(Err(SensorError::Ended { count: 0 }))?;
        reading.clone_from(&frame);
        Ok(())
    }
}

/// The test's side of a [`Given`] sensor.
struct Giver {
    asked: Receiver<()>,
    give: Sender<Reading>,
}

impl Giver {
    /// Passes a reading to the sensor. It has been processed when this returns.
    fn give(&self, reading: Reading) {
        self.give.send(reading).expect("a sensor");
        self.asked.recv().expect("a sensor that asks again");
    }
}

fn sensors(thresholds: FlagThresholds) -> (Vec<Giver>, Vec<BackgroundSensor>, NewDataSignal) {
    let (mut givers, mut sensors) = (Vec::new(), Vec::new());
    for _ in 0..2 {
        let ((asks, asked), (give, given)) = (channel(), channel());
        givers.push(Giver { asked, give });
        sensors.push(Given { asks, given });
    }
    let (touches, arrivals) = live(sensors, thresholds).expect("threads");
    for giver in &givers {
        giver.asked.recv().expect("a sensor that asks");
    }
    (givers, touches, arrivals)
}

/// Frame `sequence` of a finger's camera at 100 Hz.
fn frame(sequence: u64, force: f64) -> Reading {
    Ok(pressed(sequence, 0.01 * sequence as f64, force))
}

const NOW: Duration = Duration::ZERO;

#[test]
fn flags_since_the_last_step_are_merged_without_waiting() {
    let thresholds = config().control.thresholds();
    let (givers, mut touches, mut arrivals) = sensors(thresholds);
    let mut touch = TactileReading::none(ELEMENTS);
    touches[0].touch(&mut touch).unwrap();
    assert!(touch.stamp.is_nan());

    givers[0].give(frame(1, 0.0));
    assert_eq!(arrivals.wait_for(NOW), None);
    givers[1].give(frame(1, 0.0));
    let first = arrivals.wait_for(NOW).expect("both");
    // Pressed too hard in one image and not in the next.
    givers[0].give(frame(2, 10.0));
    givers[0].give(frame(3, 0.0));
    assert!(arrivals.wait_for(NOW).expect("both") > first);
    assert_no_alloc(|| touches[0].touch(&mut touch)).unwrap();
    assert_eq!((touch.frame.sequence, touch.stamp), (3, 0.03));
    // The frames before are available for a recording.
    let earlier = touches[0].earlier_frames().iter();
    let earlier: Vec<_> = earlier
        .map(|f| (f.sequence, f.stamp, f.forces[0].z))
        .collect();
    assert_eq!(earlier, [(1, 0.01, 0.0), (2, 0.02, 10.0)]);
    assert!(touch.flags.over && touch.flags.largest_element == Some(0));
    assert_eq!(touch.frame.forces[0].z, 0.0);
    assert_eq!(arrivals.wait_for(NOW), None);

    // Repeated and lost images are not new data.
    touches[1].touch(&mut touch).unwrap();
    givers[0].give(frame(4, 0.0));
    givers[1].give(frame(1, 0.0));
    let lost = CameraError::Unreadable {
        name: "a picture".into(),
        reason: "cut off".into(),
    };
    givers[1].give(Err(lost.into()));
    assert_eq!(arrivals.wait_for(NOW), None);
    let mut again = TactileReading::none(ELEMENTS);
    touches[1].touch(&mut again).unwrap();
    assert_eq!(again, touch);
}

/// Runs steps that follow the images of a hand. After `pictures` images, finger 1 stalls or, if `fails`, its sensor
/// fails.
fn run(pictures: u64, fails: bool) -> (Vec<StopReason>, ControlLoop<BackgroundSensor, IdealHand>) {
    let mut config = config();
    config.control.stale_periods = 3.5;
    let (givers, touches, arrivals) = sensors(config.control.thresholds());
    let hand = hand_at_home(&config);
    let mut control_loop = ControlLoop::new(touches, hand, controller(&config));
    let mut schedule = DataDriven::new(arrivals, 1e-3).expect("a period");
    let mut next = 0;
    let mut give = move || {
        givers[0].give(frame(next, 0.0));
        if next < pictures {
            givers[1].give(frame(next, 0.0));
        } else if fails {
            let ended = SensorError::Ended { count: next };
            givers[1].give.send(Err(ended)).expect("a sensor");
            // The sensor's thread has dropped it.
            assert!(givers[1].asked.recv().is_err());
        }
        next += 1;
    };
    give();
    let go_on = AtomicBool::new(false);
    let mut reasons = Vec::new();
    let ran = control_loop.run(&mut schedule, u64::MAX, &go_on, |control_loop, _| {
        reasons.extend(control_loop.controller().stop_reason().cloned());
        match reasons.is_empty() {
            true => {
                give();
                ControlFlow::Continue(())
            }
            false => ControlFlow::Break(()),
        }
    });
    if ran.is_err() {
        reasons.extend(control_loop.controller().stop_reason().cloned());
    }
    (reasons, control_loop)
}

/// Steps continue, and the finger's forces become stale by the time of the data.
#[test]
fn a_stalled_camera_stops_the_hand_but_not_the_loop() {
    let (reasons, control_loop) = run(20, false);
    let [StopReason::StaleForces { finger: 1, age, .. }] = reasons[..] else {
        panic!("{reasons:?}")
    };
    // Its last image was taken at 0.19 s.
    assert!((age - 0.04).abs() < 1e-12, "{age}");
    assert!((control_loop.state().stamp - 0.23).abs() < 1e-12);
}

#[test]
fn a_sensor_that_fails_stops_the_hand_at_once() {
    let (reasons, control_loop) = run(20, true);
    assert!(
        matches!(
            reasons[..],
            [StopReason::ReadFailed {
                what: "a tactile sensor"
            }]
        ),
        "{reasons:?}"
    );
    assert!((control_loop.state().stamp - 0.20).abs() < 1e-12);
}
