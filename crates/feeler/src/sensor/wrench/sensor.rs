//! Tactile sensor of one element, from a camera and a wrench calibration.

use super::WrenchAxis;
use super::basis::Basis;
use super::calibration::{CalibrationOf, check_count};
use super::error::WrenchError;
use super::estimator::{WrenchEstimate, WrenchEstimator};
use crate::sensor::forces::reading::{NO_FORCE, SensorError, TactileFrame, TactileSensor};
use crate::sensor::forces::sensing::{ElementReading, SensingChain, SensingError};
use crate::sensor::image::camera::{Camera, CameraError};
use crate::sensor::image::frame::Frame;
use glam::{DMat3, DVec3};

/// Maximum novelty for which a force is reported; above it, the missing force stops the hand.
const FARTHEST_NOVELTY: f64 = 2.0;

/// A fingertip that measures only the total force.
///
/// Its single element is at the apex, with the normal along the dome's axis. The calibrated force f acts on the
/// fingertip by the object, in a frame whose z axis points outward along the dome's axis; pressing therefore gives a
/// negative `f_z`. Since an element's z is compression, positive when pressed, the element's force is `(f_x, f_y,
/// -f_z)`. If the force was measured in another frame or on the object, use [`with_axes`](Self::with_axes).
///
/// Reports [`NO_FORCE`], which stops the hand, if too few elements are lit or if the image's novelty is above 2, since
/// a force would be unreliable. For a novelty between 1 and 2, the force is extrapolated. Allocates only during
/// construction; [`read`](TactileSensor::read) does not allocate, unless [markers are
/// tracked](SensingChain::with_tracker).
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
    /// Creates a sensor that processes the images of `camera` with `sensing` and `estimator`.
    ///
    /// # Errors
    /// If `sensing` and `estimator` have different numbers of elements, or if `f_x`, `f_y` or `f_z` is not calibrated.
    pub fn new(
        camera: C,
        sensing: SensingChain,
        estimator: WrenchEstimator,
    ) -> Result<Self, WrenchError> {
        let count = sensing.element_count();
        check_forces(estimator.calibration(), count)?;
        let (width, height) = sensing.picture_size();
        Ok(Self {
            camera,
            readings: vec![ElementReading::default(); count],
            sensing,
            estimator,
            axes: DMat3::IDENTITY,
            estimate: None,
            frame: Frame::black(width, height),
        })
    }

    /// Sets the matrix that converts a calibrated force to the force on the fingertip, in a frame whose z axis points
    /// outward along the dome's axis: a rotation, multiplied by -1 if the force on the object was measured.
    #[must_use]
    pub fn with_axes(self, axes: DMat3) -> Self {
        Self { axes, ..self }
    }

    /// Camera that supplies the images.
    pub fn camera(&self) -> &C {
        &self.camera
    }

    /// Mutable access to the camera, to configure it or to advance a simulated one.
    pub fn camera_mut(&mut self) -> &mut C {
        &mut self.camera
    }

    /// Wrench of the latest reading in the calibrated frame; `None` before the first reading.
    pub fn estimate(&self) -> Option<&WrenchEstimate> {
        self.estimate.as_ref()
    }
}

/// Converts the force on the fingertip by the object, in a frame whose z axis points outward along the dome's axis, to
/// an element's force, whose z is compression.
pub fn element_force(on_fingertip: DVec3) -> DVec3 {
    DVec3::new(on_fingertip.x, on_fingertip.y, -on_fingertip.z)
}

/// Checks that `calibration` is for `count` elements and contains all force components.
pub(super) fn check_forces<B: Basis>(
    calibration: &CalibrationOf<B>,
    count: usize,
) -> Result<(), WrenchError> {
    let (expected, actual) = (count, calibration.made_for.elements);
    check_count("elements of the wrench calibration", expected, actual)?;
    let forces = [WrenchAxis::ForceX, WrenchAxis::ForceY, WrenchAxis::ForceZ];
    let mut missing = forces
        .into_iter()
        .filter(|&axis| calibration.axis(axis).is_none());
    missing.next().map_or(Ok(()), |axis| {
        Err(WrenchError::Missing {
            missing: axis.name(),
        })
    })
}

/// Returns mutable access to the force of the only element.
pub(super) fn only_force(forces: &mut [DVec3]) -> Result<&mut DVec3, SensorError> {
    let actual = forces.len();
    let [force] = forces else {
        return Err(SensorError::ElementCount {
            expected: 1,
            actual,
        });
    };
    Ok(force)
}

/// Force of the fingertip's element; [`NO_FORCE`] if it is unknown or unreliable. `axes` converts the calibrated force
/// to the force on the fingertip.
pub(super) fn felt_force(estimate: &WrenchEstimate, axes: DMat3) -> DVec3 {
    let felt = estimate
        .force()
        .filter(|_| estimate.novelty <= FARTHEST_NOVELTY);
    felt.map_or(NO_FORCE, |felt| element_force(axes * felt))
}

/// Converts a sensing error to a sensor error.
fn not_sensed(error: SensingError) -> SensorError {
    match error {
        SensingError::ElementCount {
            expected, actual, ..
        } => SensorError::ElementCount { expected, actual },
        SensingError::Moments(error) => error.into(),
        // Otherwise, an image of another size, or an error that occurs only when a chain is built.
        built @ (SensingError::Fingertip(_)
        | SensingError::Calibration(_)
        | SensingError::Track(_)) => CameraError::Failed(built.to_string()).into(),
    }
}

impl<C: Camera> TactileSensor for WrenchSensor<C> {
    fn element_count(&self) -> usize {
        1
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let force = only_force(&mut reading.forces)?;
        self.camera.capture(&mut self.frame)?;
        let sensed = self.sensing.sense(&self.frame.picture, &mut self.readings);
        sensed.map_err(not_sensed)?;
        let estimate = self.estimator.estimate(&self.readings);
        *force = felt_force(&estimate, self.axes);
        self.estimate = Some(estimate);
        reading.sequence = self.frame.sequence;
        reading.stamp = self.frame.stamp;
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        Some(&self.frame)
    }
}
