//! Control by a measured wrench: a fingertip of one element touches a wall, strokes it and returns.

use super::world::{chain, made_for, picture, samples};
use feeler::control::task::TaskConfig;
use feeler::control::{ControlConfig, ControlLoop, Controller, FlaggedSensor, Phase};
use feeler::hand::kinematics::fingertip_pose;
use feeler::hand::{
    FingerConfig, FingerGeometry, Hand, HandCommand, HandError, HandState, JointState, JointVector,
    inverse_kinematics,
};
use feeler::pace::FreeRunning;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler::sensor::wrench::{WrenchError, WrenchEstimator, WrenchSensor, fit};
use glam::{DMat3, DVec3};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

#[derive(serde::Deserialize)]
struct Config {
    finger: FingerConfig,
    layout: LayoutConfig,
    control: ControlConfig,
    task: TaskConfig,
}

/// Joint angles (rad) and time (s).
type Rig = Rc<Cell<(JointVector, f64)>>;

struct Drives {
    rig: Rig,
    velocity: JointVector,
    period: f64,
}

impl Hand for Drives {
    fn finger_count(&self) -> usize {
        1
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        let (position, stamp) = self.rig.get();
        let velocity = self.velocity;
        state.stamp = stamp;
        state.joints.fill(JointState { position, velocity });
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.velocity = command.joint_velocity()[0];
        let (position, stamp) = self.rig.get();
        self.rig
            .set((position + self.period * self.velocity, stamp + self.period));
        Ok(())
    }
}

/// A camera that sees the spots under the force of an elastic wall.
struct Eye {
    rig: Rig,
    finger: FingerGeometry,
    tip: DVec3,
    frames: u64,
    random: Pcg64,
}

impl Camera for Eye {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let (theta, stamp) = self.rig.get();
        let (centre, rotation) = fingertip_pose(&self.finger, theta);
        let depth = (centre + rotation * self.tip).x + 0.018;
        let pushed = DVec3::NEG_Z * (200.0 * depth).max(0.0);
        frame.picture = picture(pushed, 1.0, &mut self.random);
        (frame.sequence, frame.stamp) = (self.frames, stamp);
        self.frames += 1;
        Ok(())
    }
}

fn estimator() -> WrenchEstimator {
    let samples = samples(250, 0, 1.0, 1);
    let fit = fit(made_for(), &["a".into()], &samples, false).expect("a fit");
    WrenchEstimator::new(fit.calibration).expect("an estimator")
}

#[derive(Debug)]
struct Still(DVec3);

impl Camera for Still {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        frame.picture = picture(self.0, 1.0, &mut Pcg64::seed_from_u64(4));
        Ok(())
    }
}

#[test]
fn compression_is_positive_and_implausible_wrenches_are_invalid() {
    let mut reading = TactileFrame::unloaded(1);
    let force = DVec3::new(0.5, -0.3, -2.0);
    let mut sensor = WrenchSensor::new(Still(force), chain(), estimator()).unwrap();
    sensor.read(&mut reading).unwrap();
    // The tolerance of the estimator's own test is a tenth of a newton.
    assert!(
        (reading.forces[0] - DVec3::new(0.5, -0.3, 2.0)).length() < 0.15,
        "{reading:?}"
    );
    let turned = DMat3::from_cols(DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z);
    let mut sensor = sensor.with_axes(turned);
    sensor.read(&mut reading).unwrap();
    assert!(
        (reading.forces[0] - DVec3::new(-0.5, 0.3, -2.0)).length() < 0.15,
        "{reading:?}"
    );
    assert!(sensor.estimate().is_some_and(|estimate| estimate.valid));
    *sensor.camera_mut() = Still(DVec3::new(0.0, 0.0, -15.0));
    sensor.read(&mut reading).unwrap();
    assert_eq!(reading.first_invalid(), Some(0));
    assert!(sensor.read(&mut TactileFrame::unloaded(2)).is_err());

    let mut pictures = samples(80, 0, 1.0, 1);
    for sample in &mut pictures {
        sample.wrench[1] = None;
    }
    let fit = fit(made_for(), &["a".into()], &pictures, false).expect("a fit");
    let estimator = WrenchEstimator::new(fit.calibration).expect("an estimator");
    let refused = WrenchSensor::new(Still(force), chain(), estimator).unwrap_err();
    assert!(
        matches!(refused, WrenchError::Missing { missing: "f_y" }),
        "{refused}"
    );
}

#[test]
fn a_hand_touches_strokes_and_returns_by_its_wrench() {
    let mut config: Config =
        toml::from_str(include_str!("../../../examples/own_hand.toml")).unwrap();
    config.layout.rings.truncate(1);
    let (period, thresholds) = (config.control.period, config.control.thresholds());
    let finger = FingerGeometry::new(&config.finger).unwrap();
    let layout = ElementLayout::new(&config.layout);
    assert_eq!(layout.elements.len(), 1, "one element, at the apex");
    let home = config.task.homes()[0].into();
    let home = inverse_kinematics(&finger, home, finger.joint_lower()).unwrap();
    let controller = Controller::new(
        config.control,
        &config.task,
        std::slice::from_ref(&finger),
        std::slice::from_ref(&layout),
    );
    let rig = Rig::new(Cell::new((home, 0.0)));
    let eye = Eye {
        rig: rig.clone(),
        finger,
        tip: layout.tip(0),
        frames: 0,
        random: Pcg64::seed_from_u64(8),
    };
    let sensor = WrenchSensor::new(eye, chain(), estimator()).unwrap();
    let hand = Drives {
        rig,
        velocity: JointVector::default(),
        period,
    };
    let sensors = vec![FlaggedSensor::new(sensor, thresholds)];
    let mut control_loop = ControlLoop::new(sensors, hand, controller.unwrap());
    let mut greatest = 0.0_f64;
    let mut steps = 0;
    let interrupted = AtomicBool::new(false);
    let ran = control_loop.run(&mut FreeRunning::default(), 10, &interrupted, |after, _| {
        greatest = greatest.max(after.touches()[0].flags.grasp_force);
        steps += 1;
        match after.controller().phase() {
            Phase::Done | Phase::Stopped => ControlFlow::Break(()),
            _ if steps > 20_000 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    ran.unwrap();
    assert_eq!(control_loop.controller().phase(), Phase::Done);
    // It moves on at 0.5 N, and presses no deeper than it moves in the steps until it has turned.
    assert!((0.5..1.0).contains(&greatest), "{greatest} N");
}
