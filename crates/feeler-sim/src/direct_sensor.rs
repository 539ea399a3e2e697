//! Fingertips whose forces are sensed directly.

use super::config::DirectSensingConfig;
use super::random::{Generator, Purpose, generator, normal};
use super::rig::SimRig;
use super::sensor_faults::SensorFaults;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};

/// A fingertip whose true forces are read, with noise, and no picture is made: for speed.
pub struct DirectSensor {
    rig: SimRig,
    finger: usize,
    config: DirectSensingConfig,
    random: Generator,
    faults: SensorFaults,
    /// The newest reading.
    newest: TactileFrame,
}

impl DirectSensor {
    /// The fingertip of `finger` with its `faults`, its noise drawn from `seed`.
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
            random: generator(seed, Purpose::SensorNoise(finger)),
            faults,
            newest: TactileFrame::unloaded(elements),
        }
    }
}

impl TactileSensor for DirectSensor {
    fn element_count(&self) -> usize {
        self.newest.forces.len()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let (expected, actual) = (self.element_count(), reading.forces.len());
        if actual != expected {
            return Err(SensorError::ElementCount { expected, actual });
        }
        let world = self.rig.world();
        world.element_forces(self.finger, &mut reading.forces);
        let arrival = self.faults.expose(world.state().time, &mut reading.forces);
        if let Some(arrival) = arrival {
            if !arrival.frozen {
                for force in &mut reading.forces {
                    force.x += normal(&mut self.random, self.config.shear_noise);
                    force.y += normal(&mut self.random, self.config.shear_noise);
                    force.z += normal(&mut self.random, self.config.normal_noise);
                }
                self.newest.forces.copy_from_slice(&reading.forces);
            }
            self.newest.sequence = arrival.sequence;
            self.newest.stamp = arrival.stamp;
        }
        reading.forces.copy_from_slice(&self.newest.forces);
        reading.sequence = self.newest.sequence;
        reading.stamp = self.newest.stamp;
        Ok(())
    }
}
