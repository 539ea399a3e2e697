//! Contact of a fingertip with an object, from the forces on its elements.
//!
//! [`ContactEstimator`] computes the position and size of the contact, its resultant force and torsion, and the
//! fraction of sliding elements. The latter requires the coefficient of friction; if not given, it is estimated while a
//! contact begins to slide.
//!
//! ```
//! use feeler::sensor::contact::ContactEstimator;
//! use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
//! use feeler::sensor::forces::TactileFrame;
//! use glam::DVec3;
//!
//! let layout = ElementLayout::new(&LayoutConfig::default());
//! let mut frame = TactileFrame::unloaded(layout.elements.len());
//! frame.forces[0] = DVec3::new(0.2, 0.0, 0.8);
//! let mut estimator = ContactEstimator::new(layout.places(), 0.1);
//! let contact = estimator.estimate(&frame.forces).expect("an element touches");
//! assert!((contact.centre - layout.tip(0)).length() < 1e-9);
//! assert_eq!(contact.touching, 1);
//! ```

mod ellipse;
mod estimator;
mod friction;

pub use ellipse::ContactEllipse;
pub use estimator::{Contact, ContactEstimator};
