//! Why a simulated world cannot be built or go on.

use super::shape::ShapeError;

/// Why a simulated world cannot be built or go on.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// An object's shape cannot be made.
    #[error("sim.object.{object}.shape: {source}")]
    Shape {
        /// The object.
        object: String,
        /// What is wrong with its shape.
        source: ShapeError,
    },
    /// An exception is made for a feeler that does not exist.
    #[error("sim.element: there is no element {element} on finger {finger}: expected {expected}")]
    NoSuchElement {
        /// The finger.
        finger: usize,
        /// The element.
        element: usize,
        /// What there is.
        expected: String,
    },
    /// A feeler is inside an object before anything has moved.
    #[error(
        "sim.object.{object}: element {element} of finger {finger} starts {:.3} mm deep in it; \
         expected a start without contact",
        1e3 * depth
    )]
    StartsInside {
        /// The object.
        object: String,
        /// The finger.
        finger: usize,
        /// The element.
        element: usize,
        /// How deep its tip is, m.
        depth: f64,
    },
    /// Two objects are inside each other before anything has moved.
    #[error(
        "sim.object.{object}: starts {:.3} mm deep in sim.object.{other}; expected objects apart",
        1e3 * depth
    )]
    Overlap {
        /// The object.
        object: String,
        /// The other one.
        other: String,
        /// How deep, m.
        depth: f64,
    },
    /// A quantity is no longer a finite number.
    #[error("step {step} of the simulated world made {quantity} not finite: {value}")]
    NotFinite {
        /// The step, from 1.
        step: u64,
        /// The quantity.
        quantity: String,
        /// What it became.
        value: String,
    },
}
