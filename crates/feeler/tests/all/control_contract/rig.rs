//! A hand of two fingers, its controller and test sensors.

use super::hand::IdealHand;
use feeler::control::task::TaskConfig;
use feeler::control::task::screw::ScrewConfig;
use feeler::control::{ControlConfig, Controller, FlagAnalyzer, TactileReading};
use feeler::hand::{FingerConfig, FingerGeometry, HandState, JointVector, inverse_kinematics};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler::sensor::forces::TactileFrame;
use serde::Deserialize;

pub const ELEMENTS: usize = 41;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    pub finger: Vec<FingerConfig>,
    pub control: ControlConfig,
    pub task: TaskConfig,
}

pub fn config() -> Config {
    toml::from_str(include_str!("two-fingers.toml")).expect("two fingers")
}

pub fn layout() -> ElementLayout {
    ElementLayout::new(&LayoutConfig::default())
}

pub fn geometries(config: &Config) -> Vec<FingerGeometry> {
    let fingers = config.finger.iter();
    fingers
        .map(|f| FingerGeometry::new(f).expect("a finger"))
        .collect()
}

pub fn controller(config: &Config) -> Controller {
    let layouts = vec![layout(); config.finger.len()];
    Controller::new(
        config.control.clone(),
        &config.task,
        &geometries(config),
        &layouts,
    )
    .expect("a controller")
}

/// Configuration of the screw task.
pub fn screw(config: &mut Config) -> &mut ScrewConfig {
    let TaskConfig::Screw(screw) = &mut config.task else {
        panic!("a screw task")
    };
    screw
}

/// Joint angles of each finger at home (rad).
pub fn home(config: &Config) -> Vec<JointVector> {
    let fingers = geometries(config).into_iter().zip(config.task.homes());
    fingers
        .map(|(geometry, home)| {
            let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
            inverse_kinematics(&geometry, home.into(), middle).expect("home")
        })
        .collect()
}

pub fn hand_at_home(config: &Config) -> IdealHand {
    IdealHand::new(home(config), config.control.period)
}

/// Measured state of `hand`.
pub fn state(hand: &IdealHand) -> HandState {
    HandState {
        stamp: hand.stamp,
        joints: hand.joints.clone(),
        efforts: Vec::new(),
    }
}

/// A frame in which element 0 is pressed with `force` (N).
pub fn pressed(sequence: u64, stamp: f64, force: f64) -> TactileFrame {
    let mut frame = TactileFrame {
        sequence,
        stamp,
        ..TactileFrame::unloaded(ELEMENTS)
    };
    frame.forces[0].z = force;
    frame
}

/// Flag analyzers of a hand, which convert frames to the controller's input.
pub struct Analyzers(Vec<FlagAnalyzer>);

impl Analyzers {
    pub fn new(config: &Config) -> Self {
        let analyzer = FlagAnalyzer::new(config.control.thresholds(), ELEMENTS);
        // More than the number of fingers, for input with too many frames.
        Self(vec![analyzer; 4])
    }

    pub fn touches(&mut self, frames: &[TactileFrame]) -> Vec<TactileReading> {
        let pairs = frames.iter().zip(&mut self.0);
        pairs
            .map(|(frame, analyzer)| {
                let mut touch = TactileReading::none(frame.forces.len());
                touch.frame.clone_from(frame);
                touch.analyze(analyzer);
                touch
            })
            .collect()
    }
}
