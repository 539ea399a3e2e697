//! What a tactile sensor says: one tri-axial force for every sensing element.

use super::{
    camera::CameraError, frame::Frame, layout::ElementLayout, moments_config::MomentsError,
};
use glam::DVec3;

/// What stands in a [`TactileFrame`] for the force at an element that has no valid one. No component is a
/// number, and neither is anything that is calculated from it.
pub const NO_FORCE: DVec3 = DVec3::NAN;

/// The forces on all sensing elements of one fingertip at one time.
///
/// Allocated once with [`TactileFrame::unloaded`] and filled again and again.
#[derive(Debug, Clone, PartialEq)]
pub struct TactileFrame {
    /// Sequence number of the picture that the forces come from.
    pub sequence: u64,
    /// Time of that picture, s.
    pub stamp: f64,
    /// Force at each element in its own frame `E_i`, N: `x`, `y` are the tangential force on the
    /// feeler by the object along the element's x, y; `z` is the compression, the force on the
    /// feeler by the object along -z, positive when pressed. [`NO_FORCE`] where it is unknown because
    /// the sub-region is dark or saturated; the controller refuses a frame with such an element.
    pub forces: Vec<DVec3>,
}

impl TactileFrame {
    /// A frame of `elements` elements without load, at time 0.
    pub fn unloaded(elements: usize) -> Self {
        Self {
            sequence: 0,
            stamp: 0.0,
            forces: vec![DVec3::ZERO; elements],
        }
    }

    /// Whether the force at `element` is valid; none is where there is no such element.
    pub fn is_valid(&self, element: usize) -> bool {
        self.forces.get(element).is_some_and(|f| !f.is_nan())
    }

    /// Resultant force on the fingertip by what it touches, N, in the fingertip's frame `T`: the sum over
    /// the elements of `layout`. An object that presses on the apex pushes the fingertip along -x, so
    /// that x is negative. Not a number where an element has no valid force.
    pub fn resultant(&self, layout: &ElementLayout) -> DVec3 {
        let elements = layout.elements.iter().zip(&self.forces);
        elements.fold(DVec3::ZERO, |sum, (element, &force)| {
            sum + element.force_on_fingertip(force)
        })
    }

    /// The first element without a valid force, if there is one.
    pub fn first_invalid(&self) -> Option<usize> {
        self.forces.iter().position(|force| force.is_nan())
    }
}

/// Why a tactile sensor delivered no forces.
#[derive(Debug, thiserror::Error)]
pub enum SensorError {
    /// The camera delivered no frame.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The camera's picture could not be evaluated.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The tactile frame to fill is for another number of elements.
    #[error("the sensor has {expected} elements, the tactile frame to fill has {actual}")]
    ElementCount {
        /// Elements of the sensor.
        expected: usize,
        /// Elements of the frame to fill.
        actual: usize,
    },
    /// The table that readings stand in cannot be read.
    #[error("the table of readings cannot be read: {0}")]
    Table(std::io::Error),
    /// The sensor cannot go on, or what it says is of no use.
    #[error("{0}")]
    Failed(String),
    /// There is no further reading (the end of a recording).
    #[error("no tactile frame after the {count} on record")]
    Ended {
        /// How many there were.
        count: u64,
    },
}

/// Something that measures the tri-axial forces on one fingertip's sensing elements.
pub trait TactileSensor {
    /// Number of sensing elements.
    fn element_count(&self) -> usize;

    /// Fills `reading` with the newest forces.
    ///
    /// # Errors
    /// When `reading` is for another number of elements, or nothing could be measured.
    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError>;

    /// The picture that the newest forces come from, where they come from one.
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
