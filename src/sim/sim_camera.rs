//! The camera inside a simulated fingertip.

use super::optics::{OpticsScratch, render};
use super::optics_config::{OpticsConfig, OpticsError};
use super::optics_model::OpticsModel;
use super::random::{Generator, Purpose, generator};
use super::rig::Rig;
use crate::sensor::camera::{Camera, CameraError};
use crate::sensor::fingertip::Fingertip;
use crate::sensor::frame::Frame;
use glam::DVec3;

/// Takes pictures of one finger's dome. The picture is all that it tells of the forces.
pub struct SimCamera {
    rig: Rig,
    finger: usize,
    optics: OpticsModel,
    scratch: OpticsScratch,
    forces: Vec<DVec3>,
    random: Generator,
    sequence: u64,
}

impl SimCamera {
    /// The camera in the fingertip of `finger`, its noise drawn from `seed`.
    ///
    /// # Errors
    /// When the optics make no sense.
    pub fn new(
        rig: Rig,
        finger: usize,
        fingertip: &Fingertip,
        optics: &OpticsConfig,
        seed: u64,
    ) -> Result<Self, OpticsError> {
        let optics = OpticsModel::new(optics, &fingertip.layout, &fingertip.projection)?;
        Ok(Self {
            rig,
            finger,
            scratch: OpticsScratch::new(&optics),
            optics,
            forces: vec![DVec3::ZERO; fingertip.layout.elements.len()],
            random: generator(seed, Purpose::SensorNoise(finger)),
            sequence: 0,
        })
    }
}

impl Camera for SimCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        frame.stamp = {
            let world = self.rig.world();
            world.element_forces(self.finger, &mut self.forces);
            world.state().time
        };
        let (random, picture) = (&mut self.random, &mut frame.picture);
        render(
            &self.optics,
            &mut self.scratch,
            &self.forces,
            random,
            picture,
        )
        .map_err(|error| CameraError::Failed(error.to_string()))?;
        frame.sequence = self.sequence;
        self.sequence += 1;
        Ok(())
    }
}
