//! Fingertips whose forces are sensed directly.

use super::config::DirectSensingConfig;
use super::random::{Generator, Purpose, generator, normal};
use super::rig::Rig;
use crate::sensor::reading::{SensorError, TactileFrame, TactileSensor};

/// A fingertip whose true forces are read, with noise, and no picture is made: for speed.
pub struct DirectSensor {
    rig: Rig,
    finger: usize,
    elements: usize,
    config: DirectSensingConfig,
    random: Generator,
    sequence: u64,
}

impl DirectSensor {
    /// The fingertip of `finger`, its noise drawn from `seed`.
    pub fn new(rig: Rig, finger: usize, config: DirectSensingConfig, seed: u64) -> Self {
        let elements = rig.world().model().fingers[finger].normals.len();
        Self {
            rig,
            finger,
            elements,
            config,
            random: generator(seed, Purpose::SensorNoise(finger)),
            sequence: 0,
        }
    }
}

impl TactileSensor for DirectSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let (expected, actual) = (self.elements, reading.forces.len());
        if actual != expected {
            return Err(SensorError::ElementCount { expected, actual });
        }
        let world = self.rig.world();
        world.element_forces(self.finger, &mut reading.forces);
        for force in &mut reading.forces {
            force.x += normal(&mut self.random, self.config.shear_noise);
            force.y += normal(&mut self.random, self.config.shear_noise);
            force.z += normal(&mut self.random, self.config.normal_noise);
        }
        reading.stamp = world.state().time;
        reading.sequence = self.sequence;
        self.sequence += 1;
        Ok(())
    }
}
