//! The fingertips' sensors of one run.

use super::{ExperimentError, Sensor};
use crate::config::{Experiment, Sensing};
use crate::control::touch::AnalyzedSensor;
use crate::sensor::fingertip::{Fingertip, FingertipConfig, FingertipError};
use crate::sensor::layout::ElementLayout;
use crate::sensor::optical::OpticalSensor;
use crate::sim::direct_sensor::DirectSensor;
use crate::sim::rig::Rig;
use crate::sim::sensor_faults::SensorFaults;
use crate::sim::sim_camera::SimCamera;

/// One sensor per finger.
pub(super) fn sensors(
    experiment: &Experiment,
    rig: &Rig,
    layouts: &[ElementLayout],
) -> Result<Vec<Sensor>, ExperimentError> {
    let config = &experiment.config;
    let mut fingertips = Fingertips::default();
    let fingers = layouts.iter().enumerate();
    fingers
        .map(|(finger, layout)| -> Result<Sensor, ExperimentError> {
            let (elements, period) = (layout.elements.len(), config.control.period);
            let faults = &config.sim.fault;
            let faults = SensorFaults::new(faults, finger, elements, period, config.seed);
            match config.sensing {
                Sensing::Image => image_sensor(experiment, rig, finger, faults, &mut fingertips),
                Sensing::Direct => {
                    let (rig, noise) = (rig.clone(), config.sim.direct_sensing.clone());
                    let sensor = DirectSensor::new(rig, finger, noise, faults, config.seed);
                    Ok(Box::new(AnalyzedSensor::new(
                        sensor,
                        config.control.thresholds(),
                    )))
                }
            }
        })
        .collect()
}

fn image_sensor(
    experiment: &Experiment,
    rig: &Rig,
    finger: usize,
    faults: SensorFaults,
    fingertips: &mut Fingertips,
) -> Result<Sensor, ExperimentError> {
    let config = &experiment.config;
    let (optics, seed) = (&config.sim.optics, config.seed);
    let own = config.sensor.fingertip(finger);
    let calibration = experiment.calibration(finger)?;
    let fingertip = fingertips
        .get(own)
        .map_err(|source| ExperimentError::Fingertip { finger, source })?;
    let camera = SimCamera::new(rig.clone(), finger, fingertip, optics, faults, seed)?;
    OpticalSensor::new(camera, own, calibration)
        .map(|sensor| {
            let analyzed = AnalyzedSensor::new(sensor, config.control.thresholds());
            Box::new(analyzed) as Sensor
        })
        .map_err(|source| ExperimentError::Sensor {
            finger,
            source: Box::new(source),
        })
}

/// Fingertips, each built once for all fingers that carry one like it: building takes its time.
#[derive(Default)]
struct Fingertips(Vec<(FingertipConfig, Fingertip)>);

impl Fingertips {
    fn get(&mut self, config: &FingertipConfig) -> Result<&Fingertip, FingertipError> {
        let found = self.0.iter().position(|(own, _)| own == config);
        let index = match found {
            Some(index) => index,
            None => {
                self.0.push((config.clone(), Fingertip::new(config)?));
                self.0.len() - 1
            }
        };
        Ok(&self.0[index].1)
    }
}
