//! The control path from image to command does not allocate, over whole runs with every phase, flag and limit.

use super::hand::IdealHand;
use assert_no_alloc::assert_no_alloc;
use feeler::control::{ControlLoop, Controller, FlaggedSensor, Phase};
use feeler::hand::HandCommand;
use feeler::sensor::calibration::Calibration;
use feeler::sensor::forces::{OpticalSensor, SensorError, TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_lab::config::{BUILT_IN, Experiment};
use feeler_lab::experiment::{self, Session, fingers_at_home, layouts};

fn experiment() -> Experiment {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/stiff-feelers.toml");
    Experiment::load(file, &[]).expect("two fingers at a cap")
}

/// A camera whose images vary in brightness.
struct Flicker(u64);

impl Camera for Flicker {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let gray = (self.0 * 16 % 256) as u8;
        frame.picture.pixels.fill(gray);
        frame.sequence = self.0;
        frame.stamp = 0.01 * self.0 as f64;
        self.0 += 1;
        Ok(())
    }
}

#[test]
fn reading_an_image_does_not_allocate() {
    let config = experiment().config;
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/experiments/reference-fingertip.calibration.toml"
    );
    let text = std::fs::read_to_string(file).expect("the calibration");
    let calibration = Calibration::from_toml(&text).expect("a calibration");
    let sensor = OpticalSensor::new(Flicker(0), &config.sensor.fingertip, calibration);
    let mut sensor = sensor.expect("a sensor");
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    for _ in 0..20 {
        let read = assert_no_alloc(|| sensor.read(&mut frame));
        assert!(read.is_ok());
    }
}

/// Replays the control of a whole run of `experiment`, and asserts that it does not allocate. Returns the controller at its
/// end.
fn replayed(experiment: &Experiment) -> Controller {
    let (fingers, _) = fingers_at_home(&experiment.config).expect("fingers");
    let layouts = layouts(&experiment.config).expect("fingertips");
    let controller = experiment::controller(experiment, &fingers, &layouts);
    let mut controller = controller.expect("a controller");
    let mut command = HandCommand::stop(fingers.len());
    let mut session = Session::new(experiment).expect("a session");
    while !session.finished() {
        session.step().expect("a step");
        let control_loop = session.control_loop();
        let (touches, state) = (control_loop.touches(), control_loop.state());
        assert_no_alloc(|| controller.decide(touches, state, &mut command));
        let name = &experiment.config.name;
        assert_eq!(command, *control_loop.command(), "{name}");
    }
    controller
}

#[test]
fn no_task_allocates() {
    for built_in in BUILT_IN {
        let settings = ["sensing=\"direct\"".to_string()];
        let experiment = Experiment::load(built_in.name, &settings).expect("an experiment");
        let controller = replayed(&experiment);
        assert_eq!(controller.phase(), Phase::Done, "{}", built_in.name);
    }
}

#[test]
fn a_policy_that_grips_does_not_allocate() {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/python");
    let file = format!("control.law.policy.file={examples}/grip-touch.safetensors");
    let settings = [file, "task.grip.law=policy".to_string()];
    let experiment = Experiment::load("grip", &settings).expect("an experiment");
    let controller = replayed(&experiment);
    assert_eq!(controller.task().outcome(), Some("put down"));
}

/// A sensor whose forces rise from frame to frame until it fails.
struct Rising(u64);

impl TactileSensor for Rising {
    fn element_count(&self) -> usize {
        41
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        if self.0 == 300 {
            return Err(SensorError::Ended { count: self.0 });
        }
        reading.sequence = self.0;
        reading.stamp = 0.01 * self.0 as f64;
        reading.forces[0].z = 0.01 * self.0 as f64;
        self.0 += 1;
        Ok(())
    }
}

#[test]
fn control_cycles_and_failures_do_not_allocate() {
    let experiment = experiment();
    let config = &experiment.config;
    let (geometries, home) = fingers_at_home(config).expect("fingers");
    let layouts = layouts(config).expect("fingertips");
    let controller = experiment::controller(&experiment, &geometries, &layouts);
    let controller = controller.expect("a controller");
    let hand = IdealHand::new(home, config.control.period);
    let sensors = [Rising(0), Rising(0)];
    let sensors = sensors.map(|sensor| FlaggedSensor::new(sensor, config.control.thresholds()));
    let mut control_loop = ControlLoop::new(sensors.into(), hand, controller);
    let failed = assert_no_alloc(|| (0..400).find_map(|_| control_loop.step().err()));
    assert!(failed.is_some());
}

#[test]
fn closing_and_opening_a_cap_by_touch_does_not_allocate() {
    for (name, outcome) in [("cap-until-closed", "closed"), ("cap-opening", "open")] {
        let experiment = Experiment::load(name, &[]).expect("an experiment");
        let mut session = Session::new(&experiment).expect("a session");
        let failed = assert_no_alloc(|| {
            while !session.finished() {
                session.step()?;
            }
            Ok::<_, feeler_lab::experiment::ExperimentError>(())
        });
        assert!(failed.is_ok(), "{failed:?}");
        let task = session.control_loop().controller().task();
        assert_eq!(task.outcome(), Some(outcome));
    }
}
