//! An optical fingertip as a [`TactileSensor`]: a [`Camera`] with a calibrated [`SensingChain`].

use super::drift::DriftConfig;
use super::reading::{SensorError, TactileFrame, TactileSensor};
use super::sensing::{SensingChain, SensingError};
use crate::sensor::calibration::element::ForceValidity;
use crate::sensor::calibration::model::Calibration;
use crate::sensor::fingertip::model::FingertipConfig;
use crate::sensor::image::camera::Camera;
use crate::sensor::image::frame::Frame;
use crate::sensor::moments::kernel::ElementMoments;

/// An optical three-axis tactile sensor (paper, section II).
///
/// All memory is allocated on construction; [`read`](TactileSensor::read) does not allocate.
#[derive(Debug)]
pub struct OpticalSensor<C> {
    camera: C,
    sensing: SensingChain,
    frame: Frame,
}

impl<C: Camera> OpticalSensor<C> {
    /// Creates a sensor for `fingertip` with images from `camera`.
    ///
    /// # Errors
    /// If the fingertip is invalid, or `calibration` was made for another one.
    pub fn new(
        camera: C,
        fingertip: &FingertipConfig,
        calibration: Calibration,
    ) -> Result<Self, SensingError> {
        let sensing = SensingChain::of_fingertip(fingertip)?;
        calibration.check()?;
        calibration.verify_target(fingertip)?;
        Ok(Self {
            camera,
            frame: Frame::black(fingertip.camera.width, fingertip.camera.height),
            sensing: sensing.with_calibration(calibration)?,
        })
    }

    /// Returns the sensor with drift correction of its moments.
    #[must_use]
    pub fn with_drift_correction(self, config: DriftConfig) -> Self {
        Self {
            sensing: self.sensing.with_drift_correction(config),
            ..self
        }
    }

    /// Camera that supplies the images.
    pub fn camera(&self) -> &C {
        &self.camera
    }

    /// Mutable access to the camera, to configure it or to advance a simulated one.
    pub fn camera_mut(&mut self) -> &mut C {
        &mut self.camera
    }

    /// Image of the latest reading.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Moments of the latest reading, one per element, after drift correction if enabled.
    pub fn moments(&self) -> &[ElementMoments] {
        self.sensing.moments()
    }

    /// Validity of the latest reading's force at each element. Does not allocate.
    pub fn validity(&self) -> impl Iterator<Item = ForceValidity> {
        self.sensing.validity()
    }
}

impl<C: Camera> TactileSensor for OpticalSensor<C> {
    fn element_count(&self) -> usize {
        self.sensing.element_count()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        reading.check_elements(self.element_count())?;
        self.camera.capture(&mut self.frame)?;
        (self.sensing).sense_forces(&self.frame.picture, &mut reading.forces)?;
        reading.sequence = self.frame.sequence;
        reading.stamp = self.frame.stamp;
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        Some(&self.frame)
    }
}
