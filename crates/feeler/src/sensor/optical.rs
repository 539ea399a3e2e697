//! A calibrated camera in a fingertip as a [`TactileSensor`]: [`SensingChain`] behind a [`Camera`].

use super::{
    calibration::{Calibration, ForceValidity},
    camera::Camera,
    drift::DriftConfig,
    fingertip::FingertipConfig,
    frame::Frame,
    moments::ElementMoments,
    reading::{SensorError, TactileFrame, TactileSensor},
    sensing::{SensingChain, SensingError},
};

/// An optical three-axis tactile sensor (paper, section II).
///
/// Everything is allocated when it is built; [`read`](TactileSensor::read) allocates nothing.
#[derive(Debug)]
pub struct OpticalSensor<C> {
    camera: C,
    sensing: SensingChain,
    frame: Frame,
}

impl<C: Camera> OpticalSensor<C> {
    /// A sensor that looks at `fingertip` through `camera`.
    ///
    /// # Errors
    /// When the fingertip makes no sense, or `calibration` was made for another one.
    pub fn new(
        camera: C,
        fingertip: &FingertipConfig,
        calibration: Calibration,
    ) -> Result<Self, SensingError> {
        let sensing = SensingChain::of_fingertip(fingertip)?;
        calibration.check()?;
        calibration.check_made_for(fingertip)?;
        Ok(Self {
            camera,
            frame: Frame::black(fingertip.camera.width, fingertip.camera.height),
            sensing: sensing.with_calibration(calibration)?,
        })
    }

    /// The same sensor with drift taken out of its moments.
    #[must_use]
    pub fn with_drift_correction(self, config: DriftConfig) -> Self {
        Self {
            sensing: self.sensing.with_drift_correction(config),
            ..self
        }
    }

    /// The camera.
    pub fn camera(&self) -> &C {
        &self.camera
    }

    /// The camera, to be set up or, in a simulation, to be moved on.
    pub fn camera_mut(&mut self) -> &mut C {
        &mut self.camera
    }

    /// The frame of the last reading.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The moments of the last reading, one for each element, without drift where it is corrected.
    pub fn moments(&self) -> &[ElementMoments] {
        self.sensing.moments()
    }

    /// How far the moments of the last reading are within what the calibration knows, one for each
    /// element. Does not allocate.
    pub fn validity(&self) -> impl Iterator<Item = ForceValidity> {
        self.sensing.validity()
    }
}

impl<C: Camera> TactileSensor for OpticalSensor<C> {
    fn element_count(&self) -> usize {
        self.sensing.element_count()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        if reading.forces.len() != self.element_count() {
            return Err(SensorError::ElementCount {
                expected: self.element_count(),
                actual: reading.forces.len(),
            });
        }
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
