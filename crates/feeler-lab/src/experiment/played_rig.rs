//! The simulated rig by itself: cameras, encoders, instruments and drives, for programs elsewhere.

use super::sensors::{RigSensor, rig_sensors};
use super::truth::SlipMeter;
use super::{ExperimentError, Instruments, layouts, rig, steps_per_command};
use crate::config::Experiment;
use feeler::hand::hand::{Hand, HandCommand, HandError, HandState};
use feeler::sensor::camera::Camera;
use feeler::sensor::frame::Frame;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler_sim::direct_sensor::DirectSensor;
use feeler_sim::rig::{Rig, SimHand};
use feeler_sim::sim_camera::SimCamera;

/// A rig that is played step by step.
pub struct PlayedRig {
    rig: Rig,
    hand: SimHand,
    sensors: Vec<PlayedSensor>,
    cap: Option<usize>,
    slip: SlipMeter,
    steps_per_period: usize,
}

enum PlayedSensor {
    Camera(Box<SimCamera>, Frame),
    Direct(DirectSensor, TactileFrame),
}

/// What a finger's sensor delivers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exposure<'a> {
    /// Its camera's newest picture.
    Picture(&'a Frame),
    /// The newest forces, where they are sensed directly.
    Forces(&'a TactileFrame),
}

impl PlayedRig {
    /// The rig of `experiment`: fingers at home, cap open.
    ///
    /// # Errors
    /// When a part of the experiment makes no sense.
    pub fn new(experiment: &Experiment) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        let layouts = layouts(config)?;
        let (rig, cap) = rig(experiment)?;
        let sensors = rig_sensors(experiment, &rig, &layouts)?;
        let sensors = sensors.into_iter().enumerate().map(|(finger, sensor)| {
            let size = &config.sensor.fingertip(finger).camera;
            match sensor {
                RigSensor::Camera(camera) => {
                    PlayedSensor::Camera(camera, Frame::black(size.width, size.height))
                }
                RigSensor::Direct(sensor) => {
                    let frame = TactileFrame::unloaded(sensor.element_count());
                    PlayedSensor::Direct(sensor, frame)
                }
            }
        });
        let steps_per_period = steps_per_command(config)?;
        let slip = SlipMeter::new(rig.world().state());
        Ok(Self {
            sensors: sensors.collect(),
            hand: SimHand::new(rig.clone(), steps_per_period),
            slip,
            rig,
            cap,
            steps_per_period,
        })
    }

    /// Number of fingers.
    pub fn fingers(&self) -> usize {
        self.sensors.len()
    }

    /// Steps of the world in a control period.
    pub fn steps_per_period(&self) -> usize {
        self.steps_per_period
    }

    /// The rig's time, s.
    pub fn time(&self) -> f64 {
        self.rig.world().state().time
    }

    /// Fills `state` with what the encoders say; what the instruments say.
    ///
    /// # Errors
    /// When `state` is for another number of fingers.
    pub fn read(&mut self, state: &mut HandState) -> Result<Instruments, HandError> {
        let instruments = Instruments::read(&self.rig, self.cap, &mut self.slip);
        self.hand.read(state)?;
        Ok(instruments)
    }

    /// Exposes the sensor of `finger`.
    ///
    /// # Errors
    /// When it delivers nothing.
    pub fn expose(&mut self, finger: usize) -> Result<Exposure<'_>, SensorError> {
        match &mut self.sensors[finger] {
            PlayedSensor::Camera(camera, frame) => camera.capture(frame)?,
            PlayedSensor::Direct(sensor, frame) => sensor.read(frame)?,
        }
        Ok(self.exposed(finger))
    }

    /// What the sensor of `finger` delivered when it was exposed last.
    pub fn exposed(&self, finger: usize) -> Exposure<'_> {
        match &self.sensors[finger] {
            PlayedSensor::Camera(_, frame) => Exposure::Picture(frame),
            PlayedSensor::Direct(_, frame) => Exposure::Forces(frame),
        }
    }

    /// Begins a control period: joint velocities are those since the last time.
    pub fn begin_period(&mut self) {
        self.hand.begin_period();
    }

    /// Advances by one step of the world, in which the drives do what `command` says.
    ///
    /// # Errors
    /// When the command is for another number of fingers, or the world cannot go on.
    pub fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.hand.advance(command)
    }
}
