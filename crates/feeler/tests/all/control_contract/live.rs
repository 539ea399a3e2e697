//! Sensors on background threads, and steps triggered by their images. No result depends on the speed of the computer: a
//! test continues when a sensor's thread requests its next image, after it has published the reading of the previous one.

use super::hand::IdealHand;
use super::rig::{ELEMENTS, config, controller, hand_at_home, pressed};
use assert_no_alloc::assert_no_alloc;
use feeler::control::ControlLoop;
use feeler::control::FlagThresholds;
use feeler::control::StopReason;
use feeler::control::{BackgroundSensor, NewDataSignal, live};
use feeler::control::{TactileReading, TactileSource};
use feeler::pace::{DataDriven, StepTrigger};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::image::CameraError;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

type Reading = Result<TactileFrame, SensorError>;

/// Camera that waits for the images of the test, and signals each request.
struct Given {
    asks: Sender<()>,
    given: Receiver<Reading>,
}

impl TactileSensor for Given {
    fn element_count(&self) -> usize {
        ELEMENTS
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        // The receiver is gone after the end of the test.
        let _ = self.asks.send(());
        let given = self.given.recv();
        let frame = given.unwrap_or(Err(SensorError::Ended { count: 0 }))?;
        reading.clone_from(&frame);
        Ok(())
    }
}

/// The test's end of a sensor.
struct Giver {
    asked: Receiver<()>,
    give: Sender<Reading>,
}

impl Giver {
    /// Gives the sensor a reading; it is at hand when this returns.
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

/// A frame of finger's newest picture at 100 Hz.
fn frame(sequence: u64, force: f64) -> Reading {
    Ok(pressed(sequence, 0.01 * sequence as f64, force))
}

const NOW: Duration = Duration::ZERO;

#[test]
fn all_flags_since_the_last_step_are_seen_and_nothing_waits() {
    let thresholds = config().control.thresholds();
    let (givers, mut touches, mut arrivals) = sensors(thresholds);
    let mut touch = TactileReading::none(ELEMENTS);
    touches[0].touch(&mut touch).unwrap();
    assert!(touch.stamp.is_nan());

    givers[0].give(frame(1, 0.0));
    assert_eq!(arrivals.wait_for(NOW), None);
    givers[1].give(frame(1, 0.0));
    let first = arrivals.wait_for(NOW).expect("both");
    // Pressed too hard in one picture and not in the next.
    givers[0].give(frame(2, 10.0));
    givers[0].give(frame(3, 0.0));
    assert!(arrivals.wait_for(NOW).expect("both") > first);
    assert_no_alloc(|| touches[0].touch(&mut touch)).unwrap();
    assert_eq!((touch.frame.sequence, touch.stamp), (3, 0.03));
    assert!(touch.flags.over && touch.flags.largest_element == Some(0));
    assert_eq!(touch.frame.forces[0].z, 0.0);
    assert_eq!(arrivals.wait_for(NOW), None);

    // The same picture again is nothing new; nor is one that is lost.
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

/// Steps that follow the pictures of a hand, whose finger 1 has none any more after `pictures` of them, or fails.
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
            // Its thread drops it.
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

/// The steps continue without it, and it is detected as stale by the time of the data.
#[test]
fn a_camera_that_stalls_stops_the_hand_as_stale_and_not_the_loop() {
    let (reasons, control_loop) = run(20, false);
    let [StopReason::StaleForces { finger: 1, age, .. }] = reasons[..] else {
        panic!("{reasons:?}")
    };
    // Its last picture is of 0.19 s.
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
