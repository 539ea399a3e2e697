//! Construction of the fingertip sensors of a run.

use super::sample_and_hold::{FrameCounter, SampleAndHold};
use crate::config::{Experiment, Sensing};
use crate::experiment::{ExperimentError, Pictures, Sensor};
use feeler::control::FlaggedSensor;
use feeler::sensor::fingertip::{ElementLayout, Fingertip};
use feeler::sensor::forces::OpticalSensor;
use feeler::sensor::image::Camera;
use feeler_sim::optics::SimCamera;
use feeler_sim::rig::{DirectSensor, FaultConfig, FaultKind, SensorFaults, SimRig};

/// Simulated sensor of a finger.
pub(super) enum RigSensor {
    /// The camera in the fingertip.
    Camera(Box<SimCamera>),
    /// A sensor that provides forces without images.
    Direct(Box<DirectSensor>),
}

/// Creates one sensor per finger, with its flag analyzer. `taken` counts the frames of finger 0 if there is a frame
/// period.
pub(super) fn sensors(
    experiment: &Experiment,
    rig: &SimRig,
    layouts: &[ElementLayout],
    pictures: Pictures,
    taken: &FrameCounter,
) -> Result<Vec<Sensor>, ExperimentError> {
    let config = &experiment.config;
    let thresholds = config.control.thresholds();
    let rig_sensors = rig_sensors(experiment, rig, layouts, pictures)?;
    let fingers = rig_sensors.into_iter().enumerate();
    fingers
        .map(|(finger, sensor)| -> Result<Sensor, ExperimentError> {
            let sensor: Sensor = match sensor {
                RigSensor::Direct(sensor) => Box::new(FlaggedSensor::new(*sensor, thresholds)),
                RigSensor::Camera(camera) => optical_sensor(experiment, finger, *camera)?,
            };
            Ok(match config.simulation()?.frame_period {
                Some(period) => {
                    let taken = match finger {
                        0 => taken.clone(),
                        _ => FrameCounter::default(),
                    };
                    Box::new(SampleAndHold::new(sensor, rig.clone(), period, taken))
                }
                None => sensor,
            })
        })
        .collect()
}

/// Creates the sensor of `finger` that evaluates the images of `camera`, with its flag analyzer.
pub(super) fn optical_sensor<C: Camera + Send + 'static>(
    experiment: &Experiment,
    finger: usize,
    camera: C,
) -> Result<Sensor, ExperimentError> {
    let config = &experiment.config;
    let calibration = experiment.calibration(finger)?;
    let fingertip = config.sensor.fingertip(finger);
    let sensor = OpticalSensor::new(camera, fingertip, calibration);
    let sensor = sensor.map_err(|source| ExperimentError::Sensor {
        finger,
        source: Box::new(source),
    })?;
    let sensor = match config.sensor.drift {
        Some(drift) => sensor.with_drift_correction(drift),
        None => sensor,
    };
    let thresholds = config.control.thresholds();
    Ok(Box::new(FlaggedSensor::new(sensor, thresholds)))
}

/// Creates the simulated sensor of each finger.
pub(super) fn rig_sensors(
    experiment: &Experiment,
    rig: &SimRig,
    layouts: &[ElementLayout],
    pictures: Pictures,
) -> Result<Vec<RigSensor>, ExperimentError> {
    let config = &experiment.config;
    let sim = config.simulation()?;
    let fingers = layouts.iter().enumerate();
    let sensors = fingers
        .map(|(finger, layout)| {
            let (elements, period) = (layout.elements.len(), config.control.period);
            let (seed, rig) = (config.seed, rig.clone());
            let faults = SensorFaults::new(&sim.fault, finger, elements, period, seed);
            if config.sensing == Sensing::Direct {
                let noise = sim.direct_sensing.clone();
                let sensor = DirectSensor::new(rig, finger, noise, faults, seed);
                return Ok(RigSensor::Direct(Box::new(sensor)));
            }
            let fingertip = Fingertip::new(config.sensor.fingertip(finger))
                .map_err(|source| ExperimentError::Fingertip { finger, source })?;
            let optics = &sim.optics;
            let camera = SimCamera::new(rig, finger, &fingertip, optics, faults, seed)?;
            let camera = match pictures {
                Pictures::Whole => camera,
                Pictures::Sensed => camera.drawing_only(fingertip.kernel.pixels()),
            };
            Ok(RigSensor::Camera(Box::new(camera)))
        })
        .collect::<Result<Vec<_>, ExperimentError>>();
    sensors.map(|sensors| swapped(sensors, &sim.fault))
}

/// Exchanges sensors between fingers as configured in `faults`.
fn swapped(mut sensors: Vec<RigSensor>, faults: &[FaultConfig]) -> Vec<RigSensor> {
    for fault in faults {
        if let FaultKind::SwappedSensors { finger, other } = fault.kind {
            sensors.swap(finger, other);
        }
    }
    sensors
}
