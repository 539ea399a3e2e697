//! One run in one process: the simulated rig, its sensors and the control loop, wired up.

pub mod log;

use crate::config::{ExperimentConfig, Sensing};
use crate::control::control_loop::{ControlError, ControlLoop};
use crate::control::controller::Controller;
use crate::control::task::Phase;
use crate::hand::finger::{FingerError, FingerGeometry};
use crate::hand::inverse_kinematics::{KinematicsError, inverse_kinematics};
use crate::sensor::layout::ElementLayout;
use crate::sensor::reading::TactileSensor;
use crate::sim::cap::CapState;
use crate::sim::model::Model;
use crate::sim::rig::{DirectSensor, Rig, SimHand};
use crate::sim::torque_sensor::TorqueReading;
use crate::sim::world::World;
use glam::DVec3;

/// Why a run could not be set up or go on.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    #[error("hand.finger[{finger}]: {source}")]
    Finger { finger: usize, source: FingerError },
    #[error("task.finger[{finger}].home: {source}")]
    Home {
        finger: usize,
        source: KinematicsError,
    },
    #[error(transparent)]
    Control(#[from] ControlError),
}

/// A run under way.
pub struct Session {
    rig: Rig,
    control_loop: ControlLoop<Box<dyn TactileSensor + Send>, SimHand>,
    time_limit: f64,
}

/// What the rig's own instruments say, beside what the hand feels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instruments {
    pub torque: TorqueReading,
    pub cap: CapState,
    pub cap_centre: DVec3,
}

impl Session {
    pub fn new(config: &ExperimentConfig) -> Result<Self, ExperimentError> {
        let layout = ElementLayout::new(&config.sensor.layout);
        let mut fingers = Vec::new();
        let mut joints = Vec::new();
        for (finger, (hand, path)) in config
            .hand
            .finger
            .iter()
            .zip(&config.task.finger)
            .enumerate()
        {
            let geometry = FingerGeometry::new(hand)
                .map_err(|source| ExperimentError::Finger { finger, source })?;
            let home = DVec3::from_array(path.home);
            let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
            joints.push(
                inverse_kinematics(&geometry, home, middle)
                    .map_err(|source| ExperimentError::Home { finger, source })?,
            );
            fingers.push(geometry);
        }
        let seed = config.seed;
        let controller = Controller::new(
            config.control.clone(),
            config.task.clone(),
            &fingers,
            &layout,
        );
        let model = Model::new(&config.sim, fingers, layout, seed);
        let rig = Rig::new(World::new(model, &joints, seed));
        let steps = (config.control.period / config.sim.step).round() as usize;
        let hand = SimHand::new(rig.clone(), steps);
        let sensors: Vec<Box<dyn TactileSensor + Send>> = (0..joints.len())
            .map(|finger| match config.sensing {
                Sensing::Direct | Sensing::Image => Box::new(DirectSensor::new(
                    rig.clone(),
                    finger,
                    config.sim.direct_sensing.clone(),
                    seed,
                ))
                    as Box<dyn TactileSensor + Send>,
            })
            .collect();
        Ok(Self {
            rig,
            control_loop: ControlLoop::new(sensors, hand, controller),
            time_limit: config.time_limit,
        })
    }

    pub fn step(&mut self) -> Result<Instruments, ExperimentError> {
        let instruments = {
            let mut world = self.rig.world();
            Instruments {
                torque: world.read_torque(),
                cap: world.state().cap,
                cap_centre: world.state().cap_pose.centre,
            }
        };
        self.control_loop.step()?;
        Ok(instruments)
    }

    pub fn finished(&self) -> bool {
        let phase = self.control_loop.controller().task().phase();
        matches!(phase, Phase::Done | Phase::Stopped)
            || self.control_loop.state().stamp >= self.time_limit
    }

    pub fn control_loop(&self) -> &ControlLoop<Box<dyn TactileSensor + Send>, SimHand> {
        &self.control_loop
    }

    pub fn rig(&self) -> &Rig {
        &self.rig
    }
}
