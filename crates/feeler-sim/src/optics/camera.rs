//! The camera inside a simulated fingertip.

use super::config::OpticsConfig;
use super::error::OpticsError;
use super::model::OpticsModel;
use super::renderer::{OpticsScratch, render};
use crate::random::{Generator, Purpose, generator};
use crate::rig::hand::SimRig;
use crate::rig::sensor_faults::SensorFaults;
use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::image::{Camera, CameraError, Frame, check_frame_size};
use glam::DVec3;

/// Renders images of one finger's dome. Forces reach the sensor only through these images.
pub struct SimCamera {
    rig: SimRig,
    finger: usize,
    optics: OpticsModel,
    scratch: OpticsScratch,
    forces: Vec<DVec3>,
    random: Generator,
    faults: SensorFaults,
    /// Latest frame, stored only if there are faults, which may repeat it.
    newest: Option<Frame>,
}

impl SimCamera {
    /// Creates the camera in the fingertip of `finger` with its `faults`; `seed` determines the noise.
    ///
    /// # Errors
    /// If the optics are invalid.
    pub fn new(
        rig: SimRig,
        finger: usize,
        fingertip: &Fingertip,
        optics: &OpticsConfig,
        faults: SensorFaults,
        seed: u64,
    ) -> Result<Self, OpticsError> {
        let projection = &fingertip.projection;
        let optics = OpticsModel::new(optics, &fingertip.layout, projection)?;
        let newest =
            (!faults.is_empty()).then(|| Frame::black(projection.width(), projection.height()));
        Ok(Self {
            rig,
            finger,
            scratch: OpticsScratch::new(&optics),
            optics,
            forces: vec![DVec3::ZERO; fingertip.layout.elements.len()],
            random: generator(seed, Purpose::SensorNoise(finger)),
            faults,
            newest,
        })
    }

    /// Restricts rendering to the region that contains `pixels` (column, row).
    #[must_use]
    pub fn drawing_only(self, pixels: impl Iterator<Item = (usize, usize)>) -> Self {
        Self {
            optics: self.optics.drawing_only(pixels),
            ..self
        }
    }

    /// Renders the image that was exposed at `stamp`.
    fn draw(&mut self, stamp: f64, frame: &mut Frame) -> Result<(), CameraError> {
        render(
            &self.optics,
            &mut self.scratch,
            &self.forces,
            &mut self.random,
            &mut frame.picture,
        )
        .map_err(|error| CameraError::Failed(error.to_string()))?;
        self.faults.overwrite_rows(stamp, &mut frame.picture);
        Ok(())
    }
}

impl Camera for SimCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let now = {
            let world = self.rig.world();
            world.element_forces(self.finger, &mut self.forces);
            world.state().time
        };
        let arrival = self.faults.expose(now, &mut self.forces);
        if let Some(arrival) = arrival.filter(|arrival| !arrival.frozen) {
            self.draw(arrival.stamp, frame)?;
        }
        if let Some(arrival) = arrival {
            frame.sequence = arrival.sequence;
            frame.stamp = arrival.stamp;
        }
        let Some(newest) = &mut self.newest else {
            return Ok(());
        };
        let size = (newest.picture.width, newest.picture.height);
        check_frame_size(size, frame)?;
        match arrival {
            Some(arrival) if !arrival.frozen => {
                newest.picture.pixels.copy_from_slice(&frame.picture.pixels);
            }
            _ => frame.picture.pixels.copy_from_slice(&newest.picture.pixels),
        }
        match arrival {
            Some(arrival) => (newest.sequence, newest.stamp) = (arrival.sequence, arrival.stamp),
            None => (frame.sequence, frame.stamp) = (newest.sequence, newest.stamp),
        }
        Ok(())
    }
}
