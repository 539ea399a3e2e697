//! The reference controller with hands and sensors to try it on.

use feeler::control::controller::Controller;
use feeler::control::flags::FlagAnalyzer;
use feeler::control::task::TaskConfig;
use feeler::control::task::screw::ScrewConfig;
use feeler::control::touch::FingerTouch;
use feeler::hand::finger::FingerGeometry;
use feeler::hand::inverse_kinematics::inverse_kinematics;
use feeler::hand::{Hand, HandCommand, HandError, HandState, JointState};
use feeler::sensor::layout::ElementLayout;
use feeler::sensor::reading::TactileFrame;
use feeler_lab::config::{Experiment, ExperimentConfig};
use glam::DVec3;

pub const ELEMENTS: usize = 41;

pub fn config() -> ExperimentConfig {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/stiff-feelers.toml");
    Experiment::load(file, &[])
        .expect("the reference experiment")
        .config
}

pub fn geometries(config: &ExperimentConfig) -> Vec<FingerGeometry> {
    let fingers = config.hand.finger.iter();
    fingers
        .map(|f| FingerGeometry::new(f).expect("a finger"))
        .collect()
}

pub fn controller(config: &ExperimentConfig) -> Controller {
    let layout = ElementLayout::new(&config.sensor.fingertip.layout);
    let layouts = vec![layout; config.hand.finger.len()];
    Controller::new(
        config.control.clone(),
        &config.task,
        &geometries(config),
        &layouts,
    )
}

/// What the reference experiment's task is tuned by.
pub fn screw(config: &mut ExperimentConfig) -> &mut ScrewConfig {
    let TaskConfig::Screw(screw) = &mut config.task else {
        panic!("a screw task")
    };
    screw
}

/// Joint angles, rad, with each finger at home.
pub fn home(config: &ExperimentConfig) -> Vec<DVec3> {
    let fingers = geometries(config).into_iter().zip(config.task.homes());
    fingers
        .map(|(geometry, home)| {
            let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
            inverse_kinematics(&geometry, home.into(), middle).expect("home")
        })
        .collect()
}

/// A hand that does exactly what it is told.
pub struct IdealHand {
    pub stamp: f64,
    pub period: f64,
    pub joints: Vec<JointState>,
    /// Every command so far.
    pub commands: Vec<HandCommand>,
}

impl IdealHand {
    pub fn at_home(config: &ExperimentConfig) -> Self {
        let at_rest = |position| JointState {
            position,
            velocity: DVec3::ZERO,
        };
        Self {
            stamp: 0.0,
            period: config.control.period,
            joints: home(config).into_iter().map(at_rest).collect(),
            commands: Vec::new(),
        }
    }

    pub fn state(&self) -> HandState {
        HandState {
            stamp: self.stamp,
            joints: self.joints.clone(),
        }
    }
}

impl Hand for IdealHand {
    fn finger_count(&self) -> usize {
        self.joints.len()
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        state.clone_from(&self.state());
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        for (joints, &velocity) in self.joints.iter_mut().zip(command.joint_velocity()) {
            joints.position += self.period * velocity;
            joints.velocity = velocity;
        }
        self.stamp += self.period;
        self.commands.push(command.clone());
        Ok(())
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

/// The flag analyzers of a hand, which turn frames into what the controller takes.
pub struct Analyzers(Vec<FlagAnalyzer>);

impl Analyzers {
    pub fn new(config: &ExperimentConfig) -> Self {
        let analyzer = FlagAnalyzer::new(config.control.thresholds(), ELEMENTS);
        // More than there are fingers, for input of too many.
        Self(vec![analyzer; 4])
    }

    pub fn touches(&mut self, frames: &[TactileFrame]) -> Vec<FingerTouch> {
        let pairs = frames.iter().zip(&mut self.0);
        pairs
            .map(|(frame, analyzer)| {
                let mut touch = FingerTouch::none(frame.forces.len());
                touch.frame.clone_from(frame);
                touch.analyze(analyzer);
                touch
            })
            .collect()
    }
}
