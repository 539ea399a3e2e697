//! A simulated rig with cameras, encoders, instruments and drives, operated by other programs.

use crate::config::{ConfigError, Experiment, Problem};
use crate::experiment::sensors::{RigSensor, rig_sensors};
use crate::experiment::truth::SlipMeter;
use crate::experiment::{
    ExperimentError, Instruments, Pictures, fingers_at_home, layouts, rig, steps_per_command,
};
use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, Frame};
use feeler_link::messages::message::InstrumentsMessage;
use feeler_link::programs::{Rig, SensorOutput};
use feeler_sim::optics::SimCamera;
use feeler_sim::rig::{DirectSensor, SimHand, SimRig};

/// A simulated rig that advances step by step.
pub struct SimRigServer {
    rig: SimRig,
    hand: SimHand,
    sensing: ServedSensing,
    steps_per_period: usize,
}

/// The simulated sensors and instruments of a rig.
pub(in crate::experiment) struct ServedSensing {
    rig: SimRig,
    sensors: Vec<PlayedSensor>,
    cap: Option<usize>,
    slip: SlipMeter,
}

enum PlayedSensor {
    Camera(Box<SimCamera>, Frame),
    Direct(Box<DirectSensor>, TactileFrame),
}

impl ServedSensing {
    /// Creates the sensors of `experiment` in the world of `rig`. `cap` is the index of the object with a thread.
    pub fn new(
        experiment: &Experiment,
        rig: &SimRig,
        cap: Option<usize>,
    ) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        if let Some(period) = config.simulation()?.frame_period {
            let problem = Problem {
                field: "sim.frame_period".into(),
                value: period.to_string(),
                expected: "no frame period: a rig for other programs sends its images with the joint angles".into(),
            };
            let (origin, problems) = (config.name.clone(), vec![problem]);
            return Err(ConfigError::OutOfRange { origin, problems }.into());
        }
        let sensors = rig_sensors(experiment, rig, &layouts(config)?, Pictures::Whole)?;
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
        let slip = SlipMeter::new(rig.world().state(), None);
        Ok(Self {
            sensors: sensors.collect(),
            rig: rig.clone(),
            cap,
            slip,
        })
    }

    /// Returns the current readings of the instruments.
    pub fn instruments(&mut self) -> InstrumentsMessage {
        (&Instruments::read(&self.rig, self.cap, &mut self.slip)).into()
    }

    /// Returns the current output of the sensor of `finger`.
    pub fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
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
}

impl SimRigServer {
    /// Creates the rig of `experiment`, with the fingers at their home positions and the cap open.
    ///
    /// # Errors
    /// If a part of the experiment is invalid.
    pub fn new(experiment: &Experiment) -> Result<Self, ExperimentError> {
        let config = &experiment.config;
        let (_, joints) = fingers_at_home(config)?;
        let (rig, cap) = rig(experiment, &joints)?;
        let steps_per_period = steps_per_command(config)?;
        Ok(Self {
            sensing: ServedSensing::new(experiment, &rig, cap)?,
            hand: SimHand::new(rig.clone(), steps_per_period),
            rig,
            steps_per_period,
        })
    }
}

impl Rig for SimRigServer {
    fn finger_count(&self) -> usize {
        self.sensing.sensors.len()
    }

    fn time(&self) -> f64 {
        self.rig.world().state().time
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        let instruments = self.sensing.instruments();
        self.hand.read(state)?;
        Ok(Some(instruments))
    }

    fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        self.sensing.expose(finger)
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
