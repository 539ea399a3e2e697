//! Readings of a tactile sensor: one tri-axial force per sensing element.

use crate::sensor::fingertip::layout::ElementLayout;
use crate::sensor::image::camera::CameraError;
use crate::sensor::image::frame::Frame;
use crate::sensor::moments::config::MomentsError;
use glam::DVec3;

/// Marks an element without a valid force in a [`TactileFrame`]. All components are NaN, which propagates through
/// calculations.
pub const NO_FORCE: DVec3 = DVec3::NAN;

/// Forces on all sensing elements of one fingertip, measured at one time.
///
/// Allocated once with [`TactileFrame::unloaded`] and reused.
#[derive(Debug, Clone, PartialEq)]
pub struct TactileFrame {
    /// Sequence number of the image from which the forces were computed.
    pub sequence: u64,
    /// Time of that image, s.
    pub stamp: f64,
    /// Force at each element in its frame `E_i`, N. `x`, `y` are the tangential force on the feeler by the object
    /// along the element's x, y; `z` is the compression, the force on the feeler by the object along -z, positive
    /// when pressed. [`NO_FORCE`] if the sub-region is dark or saturated; the controller rejects frames with such
    /// elements.
    pub forces: Vec<DVec3>,
}

impl TactileFrame {
    /// Creates a frame of `elements` unloaded elements at time 0.
    pub fn unloaded(elements: usize) -> Self {
        Self {
            sequence: 0,
            stamp: 0.0,
            forces: vec![DVec3::ZERO; elements],
        }
    }

    /// Checks that the frame has as many elements as the sensor.
    ///
    /// # Errors
    /// If the number of elements differs from `expected`.
    pub fn check_elements(&self, expected: usize) -> Result<(), SensorError> {
        let actual = self.forces.len();
        match actual == expected {
            true => Ok(()),
            false => Err(SensorError::ElementCount { expected, actual }),
        }
    }

    /// Returns whether the force at `element` is valid; `false` if there is no such element.
    pub fn is_valid(&self, element: usize) -> bool {
        self.forces.get(element).is_some_and(|f| !f.is_nan())
    }

    /// Resultant force on the fingertip by the object, N, in the fingertip's frame `T`: the sum over the elements of
    /// `layout`. An object that presses on the apex pushes the fingertip along -x, so x is negative. NaN if an
    /// element has no valid force.
    pub fn resultant(&self, layout: &ElementLayout) -> DVec3 {
        let elements = layout.elements.iter().zip(&self.forces);
        elements.fold(DVec3::ZERO, |sum, (element, &force)| {
            sum + element.force_on_fingertip(force)
        })
    }

    /// First element without a valid force, if any.
    pub fn first_invalid(&self) -> Option<usize> {
        self.forces.iter().position(|force| force.is_nan())
    }
}

/// Error of a tactile sensor.
#[derive(Debug, thiserror::Error)]
pub enum SensorError {
    /// The camera delivered no frame.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The moments of the camera's image cannot be computed.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The tactile frame to fill does not have the sensor's number of elements.
    #[error("expected a tactile frame of {expected} elements like the sensor, got {actual}")]
    ElementCount {
        /// Number of elements of the sensor.
        expected: usize,
        /// Number of elements of the frame to fill.
        actual: usize,
    },
    /// The table of readings cannot be read.
    #[error("the table of readings cannot be read: {0}")]
    Table(std::io::Error),
    /// The sensor has failed, or its readings are invalid.
    #[error("{0}")]
    Failed(String),
    /// There are no further readings (end of a recording).
    #[error("no tactile frame after the {count} in the recording")]
    Ended {
        /// Number of readings delivered.
        count: u64,
    },
}

/// A sensor that measures the tri-axial forces on one fingertip's sensing elements.
pub trait TactileSensor {
    /// Number of sensing elements.
    fn element_count(&self) -> usize;

    /// Fills `reading` with the latest forces.
    ///
    /// # Errors
    /// If `reading` has another number of elements, or the measurement fails.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError>;

    /// Image of the latest reading, or `None` if the sensor has no camera.
    fn frame(&self) -> Option<&Frame> {
        None
    }
}

impl<T: TactileSensor + ?Sized> TactileSensor for Box<T> {
    fn element_count(&self) -> usize {
        (**self).element_count()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        (**self).read(reading)
    }

    fn frame(&self) -> Option<&Frame> {
        (**self).frame()
    }
}
