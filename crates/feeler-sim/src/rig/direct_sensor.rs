//! Direct sensing: true forces plus noise, without images.

use super::hand::SimRig;
use super::sensor_faults::SensorFaults;
use crate::optics::gaussian_noise::{GAUSSIAN_BLOCK, GaussianNoise};
use crate::random::{Purpose, generator};
use crate::world::config::DirectSensingConfig;
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use glam::DVec3;

/// Number of forces whose noise is drawn at once: whole blocks of the generator.
const DRAWN: usize = 2 * GAUSSIAN_BLOCK;

/// A fingertip that returns true forces with noise, without rendering images. Faster than `SimCamera`.
pub struct DirectSensor {
    rig: SimRig,
    finger: usize,
    config: DirectSensingConfig,
    noise: GaussianNoise,
    faults: SensorFaults,
    /// Latest reading. Its forces are stored only if there are faults, which may repeat them.
    newest: TactileFrame,
}

impl DirectSensor {
    /// Creates the sensor of `finger` with its `faults`; `seed` determines the noise.
    pub fn new(
        rig: SimRig,
        finger: usize,
        config: DirectSensingConfig,
        faults: SensorFaults,
        seed: u64,
    ) -> Self {
        let elements = rig.world().model().fingers[finger].normals.len();
        Self {
            rig,
            finger,
            config,
            noise: GaussianNoise::new(&mut generator(seed, Purpose::SensorNoise(finger))),
            faults,
            newest: TactileFrame::unloaded(elements),
        }
    }

    fn add_noise(&mut self, forces: &mut [DVec3]) {
        let [across, along] = [self.config.shear_noise, self.config.normal_noise];
        for forces in forces.chunks_mut(DRAWN) {
            let mut drawn = [[0.0; 3]; DRAWN];
            let drawn = &mut drawn[..forces.len()];
            self.noise.fill(drawn.as_flattened_mut());
            for (force, &[x, y, z]) in forces.iter_mut().zip(&*drawn) {
                *force += DVec3::new(across * x, across * y, along * z);
            }
        }
    }
}

impl TactileSensor for DirectSensor {
    fn element_count(&self) -> usize {
        self.newest.forces.len()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        reading.check_elements(self.element_count())?;
        let now = {
            let world = self.rig.world();
            world.element_forces(self.finger, &mut reading.forces);
            world.state().time
        };
        let arrival = self.faults.expose(now, &mut reading.forces);
        let is_new = arrival.as_ref().is_some_and(|arrival| !arrival.frozen);
        if let Some(arrival) = arrival {
            if is_new {
                self.add_noise(&mut reading.forces);
                if !self.faults.is_empty() {
                    self.newest.forces.copy_from_slice(&reading.forces);
                }
            }
            self.newest.sequence = arrival.sequence;
            self.newest.stamp = arrival.stamp;
        }
        if !is_new {
            reading.forces.copy_from_slice(&self.newest.forces);
        }
        reading.sequence = self.newest.sequence;
        reading.stamp = self.newest.stamp;
        Ok(())
    }
}
