//! A camera and a wrench calibration as a tactile sensor of one element.

use super::WrenchAxis;
use super::error::WrenchError;
use super::estimator::{WrenchEstimate, WrenchEstimator};
use crate::sensor::camera::{Camera, CameraError};
use crate::sensor::frame::Frame;
use crate::sensor::reading::{NO_FORCE, SensorError, TactileFrame, TactileSensor};
use crate::sensor::sensing::{ElementReading, SensingChain, SensingError};
use glam::{DMat3, DVec3};

/// Novelty beyond which there is no force: a hand does not stop for a picture that is a little unusual, but for one of something else.
const FARTHEST_NOVELTY: f64 = 2.0;

/// A fingertip that feels one force: that on all of it.
///
/// Its one element sits at the apex, its normal along the dome's axis. The calibration's force f is that on the fingertip by what it
/// touches, in a frame whose z points outward along the dome's axis: what presses pushes inward, so that `f_z` is below zero. An
/// element's z is compression, positive when pressed; the element's force is therefore `(f_x, f_y, -f_z)`. Where the force was measured
/// in another frame, or that on the object, [`with_axes`](Self::with_axes) says how it is turned into this one.
///
/// There is no force ([`NO_FORCE`], which stops the hand) where too little is lit, and in a picture that is more than twice as far from
/// those of the calibration as is valid: a force there would be made up. In between it is extrapolated. Everything is allocated when it is built; [`read`](TactileSensor::read) allocates nothing.
#[derive(Debug)]
pub struct WrenchSensor<C> {
    camera: C,
    sensing: SensingChain,
    estimator: WrenchEstimator,
    axes: DMat3,
    readings: Vec<ElementReading>,
    estimate: Option<WrenchEstimate>,
    frame: Frame,
}

impl<C: Camera> WrenchSensor<C> {
    /// Senses the pictures of `camera` by `sensing` and turns what it reads into a force by `estimator`.
    ///
    /// # Errors
    /// When the two are of different numbers of elements, or `f_x`, `f_y` or `f_z` is not calibrated.
    pub fn new(
        camera: C,
        sensing: SensingChain,
        estimator: WrenchEstimator,
    ) -> Result<Self, WrenchError> {
        let (expected, actual) = (sensing.element_count(), estimator.element_count());
        if expected != actual {
            return Err(WrenchError::Count {
                what: "elements of the wrench calibration".into(),
                expected,
                actual,
            });
        }
        let forces = [WrenchAxis::ForceX, WrenchAxis::ForceY, WrenchAxis::ForceZ];
        let calibration = estimator.calibration();
        let mut missing = forces
            .into_iter()
            .filter(|&axis| calibration.axis(axis).is_none());
        if let Some(axis) = missing.next() {
            return Err(WrenchError::Missing {
                missing: axis.name(),
            });
        }
        let (width, height) = sensing.picture_size();
        Ok(Self {
            camera,
            readings: vec![ElementReading::default(); expected],
            sensing,
            estimator,
            axes: DMat3::IDENTITY,
            estimate: None,
            frame: Frame::black(width, height),
        })
    }

    /// With `axes` times a calibrated force being the force on the fingertip in a frame whose z points outward along the dome's axis:
    /// a rotation, times -1 where the force on the object was measured.
    #[must_use]
    pub fn with_axes(self, axes: DMat3) -> Self {
        Self { axes, ..self }
    }

    /// The camera.
    pub fn camera(&self) -> &C {
        &self.camera
    }

    /// The camera, to be set up or, in a simulation, to be moved on.
    pub fn camera_mut(&mut self) -> &mut C {
        &mut self.camera
    }

    /// The wrench of the last reading, in the frame in which it was calibrated; none before the first.
    pub fn estimate(&self) -> Option<&WrenchEstimate> {
        self.estimate.as_ref()
    }
}

/// The force on the fingertip by what it touches, in a frame whose z points outward along the dome's axis, as that at an element there:
/// z is compression.
pub fn element_force(on_fingertip: DVec3) -> DVec3 {
    DVec3::new(on_fingertip.x, on_fingertip.y, -on_fingertip.z)
}

/// Why a picture could not be sensed, as a sensor says it.
fn not_sensed(error: SensingError) -> SensorError {
    match error {
        SensingError::ElementCount {
            expected, actual, ..
        } => SensorError::ElementCount { expected, actual },
        SensingError::Moments(error) => error.into(),
        // The rest is found where a chain is built.
        built @ (SensingError::Fingertip(_) | SensingError::Calibration(_)) => {
            CameraError::Failed(built.to_string()).into()
        }
    }
}

impl<C: Camera> TactileSensor for WrenchSensor<C> {
    fn element_count(&self) -> usize {
        1
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let actual = reading.forces.len();
        let [force] = &mut reading.forces[..] else {
            return Err(SensorError::ElementCount {
                expected: 1,
                actual,
            });
        };
        self.camera.capture(&mut self.frame)?;
        let sensed = self.sensing.sense(&self.frame.picture, &mut self.readings);
        sensed.map_err(not_sensed)?;
        let estimate = self.estimator.estimate(&self.readings);
        let felt = estimate
            .force()
            .filter(|_| estimate.novelty <= FARTHEST_NOVELTY);
        *force = felt.map_or(NO_FORCE, |felt| element_force(self.axes * felt));
        self.estimate = Some(estimate);
        reading.sequence = self.frame.sequence;
        reading.stamp = self.frame.stamp;
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        Some(&self.frame)
    }
}
