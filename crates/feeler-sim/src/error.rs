//! Errors of a simulated world.

use crate::shapes::shape::ShapeError;

/// Error that prevents the creation of a simulated world, or ends its simulation.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// The shape of an object is invalid.
    #[error("sim.object.{object}.shape: {source}")]
    Shape {
        /// Name of the object.
        object: String,
        /// Error of the shape.
        source: ShapeError,
    },
    /// An override is for a feeler that does not exist.
    #[error("sim.element: finger {finger}, element {element}: expected {expected}")]
    NoSuchElement {
        /// Index of the finger.
        finger: usize,
        /// Index of the element.
        element: usize,
        /// Valid indices.
        expected: String,
    },
    /// A feeler is inside an object at the start.
    #[error(
        "sim.object.{object}: element {element} of finger {finger} starts {:.3} mm deep in it; \
         expected a start without contact",
        1e3 * depth
    )]
    StartsInside {
        /// Name of the object.
        object: String,
        /// Index of the finger.
        finger: usize,
        /// Index of the element.
        element: usize,
        /// Penetration depth of its tip (m).
        depth: f64,
    },
    /// Two objects overlap at the start.
    #[error(
        "sim.object.{object}: starts {:.3} mm deep in sim.object.{other}; expected objects apart",
        1e3 * depth
    )]
    Overlap {
        /// Name of the object.
        object: String,
        /// Name of the other object.
        other: String,
        /// Penetration depth (m).
        depth: f64,
    },
    /// A quantity is no longer finite.
    #[error("simulation diverged in step {step}: {quantity} is {value}")]
    NotFinite {
        /// Number of the step, from 1.
        step: u64,
        /// Name of the quantity.
        quantity: String,
        /// Value of the quantity, as text.
        value: String,
    },
}
