//! The whole chain: a camera's picture to the forces on all sensing elements.

use super::{
    calibration::{Calibration, CalibrationError, ForceValidity},
    camera::Camera,
    drift::{DriftConfig, DriftCorrection},
    fingertip::{Fingertip, FingertipConfig, FingertipError},
    frame::Frame,
    moments::{ElementMoments, MomentsKernel},
    reading::{SensorError, TactileFrame, TactileSensor},
};

/// Why an optical sensor cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum OpticalSensorError {
    /// The fingertip makes no sense.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// The calibration cannot be used with it.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}

/// An optical three-axis tactile sensor (paper, section II).
///
/// Everything is allocated when it is built; [`read`](TactileSensor::read) allocates nothing.
#[derive(Debug)]
pub struct OpticalSensor<C> {
    camera: C,
    kernel: MomentsKernel,
    drift: Option<DriftCorrection>,
    calibration: Calibration,
    frame: Frame,
    moments: Vec<ElementMoments>,
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
    ) -> Result<Self, OpticalSensorError> {
        let Fingertip { kernel, .. } = Fingertip::new(fingertip)?;
        calibration.check()?;
        calibration.check_made_for(fingertip)?;
        Ok(Self {
            camera,
            frame: Frame::black(fingertip.camera.width, fingertip.camera.height),
            moments: vec![ElementMoments::default(); kernel.element_count()],
            kernel,
            drift: None,
            calibration,
        })
    }

    /// The same sensor with drift taken out of its moments.
    #[must_use]
    pub fn with_drift_correction(mut self, config: DriftConfig) -> Self {
        self.drift = Some(DriftCorrection::new(config, &self.calibration));
        self
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
        &self.moments
    }

    /// How far the force at each element in the last reading can be trusted. Does not allocate.
    pub fn validity(&self) -> impl Iterator<Item = ForceValidity> {
        let elements = self.calibration.elements.iter().zip(&self.moments);
        elements.map(|(element, moments)| element.validity(moments))
    }
}

impl<C: Camera> TactileSensor for OpticalSensor<C> {
    fn element_count(&self) -> usize {
        self.kernel.element_count()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        if reading.forces.len() != self.element_count() {
            return Err(SensorError::ElementCount {
                expected: self.element_count(),
                actual: reading.forces.len(),
            });
        }
        self.camera.capture(&mut self.frame)?;
        self.kernel
            .measure(&self.frame.picture, &mut self.moments)?;
        if let Some(drift) = &mut self.drift {
            drift.correct(&mut self.moments);
        }
        self.calibration.forces(&self.moments, &mut reading.forces);
        reading.sequence = self.frame.sequence;
        reading.stamp = self.frame.stamp;
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        Some(&self.frame)
    }
}
