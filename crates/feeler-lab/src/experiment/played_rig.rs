//! The simulated rig by itself: cameras, encoders, instruments and drives, for programs elsewhere.

use super::sensors::{RigSensor, rig_sensors};
use super::truth::SlipMeter;
use super::{ExperimentError, Instruments, fingers_at_home, layouts, rig, steps_per_command};
use crate::config::{ConfigError, Experiment, Problem};
use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler::sensor::camera::Camera;
use feeler::sensor::frame::Frame;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler_link::message::InstrumentsMessage;
use feeler_link::programs::{Rig, SensorOutput};
use feeler_sim::direct_sensor::DirectSensor;
use feeler_sim::rig::{SimHand, SimRig};
use feeler_sim::sim_camera::SimCamera;

/// A rig that is played step by step.
pub struct PlayedRig {
    rig: SimRig,
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

impl PlayedRig {
    /// The rig of `experiment`: fingers at home, cap open.
    ///
    /// # Errors
    /// When a part of the experiment makes no sense.
    pub fn new(experiment: &Experiment) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        if let Some(period) = config.simulation()?.frame_period {
            let problem = Problem {
                field: "sim.frame_period".into(),
                value: period.to_string(),
                expected: "none of a rig for programs elsewhere, whose pictures come with the joint angles".into(),
            };
            let (origin, problems) = (config.name.clone(), vec![problem]);
            return Err(ConfigError::OutOfRange { origin, problems }.into());
        }
        let layouts = layouts(config)?;
        let (_, joints) = fingers_at_home(config)?;
        let (rig, cap) = rig(experiment, &joints)?;
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
        let slip = SlipMeter::new(rig.world().state(), None);
        Ok(Self {
            sensors: sensors.collect(),
            hand: SimHand::new(rig.clone(), steps_per_period),
            slip,
            rig,
            cap,
            steps_per_period,
        })
    }
}

impl Rig for PlayedRig {
    fn finger_count(&self) -> usize {
        self.sensors.len()
    }

    fn time(&self) -> f64 {
        self.rig.world().state().time
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        let instruments = Instruments::read(&self.rig, self.cap, &mut self.slip);
        self.hand.read(state)?;
        Ok(Some((&instruments).into()))
    }

    fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        let Some(sensor) = self.sensors.get_mut(finger) else {
            return Ok(None);
        };
        Ok(Some(match sensor {
            PlayedSensor::Camera(camera, frame) => {
                camera.capture(frame)?;
                SensorOutput::Picture(frame)
            }
            PlayedSensor::Direct(sensor, frame) => {
                sensor.read(frame)?;
                SensorOutput::Forces(frame)
            }
        }))
    }

    fn steps_per_period(&self) -> usize {
        self.steps_per_period
    }

    fn begin_period(&mut self) {
        self.hand.begin_period();
    }

    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.hand.advance(command)
    }
}
