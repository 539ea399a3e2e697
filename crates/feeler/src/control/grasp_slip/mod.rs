//! Slip of what moves with the hand: a grasped object.
//!
//! The detectors for objects that stand still ([`FlagAnalyzer`](super::flags::FlagAnalyzer),
//! [`SlipDetector`](super::slip_detector::SlipDetector)) take slip from the rate of shear, or from the fingertip's own
//! motion. In a grasp that is lifted, carried and shaken, shear changes without any slip, and the object goes along with
//! the fingertip. Two things can be told there from the elements' displacements or shears alone:
//!
//! - [`ContactLoss`]: *is the object still held?* The load on the elements, as their departure from what they are
//!   untouched; where nobody knows that, from a [`RegularPattern`] as a lens shows it.
//! - [`GraspDrag`]: *is it displaced in the grip?* The excursion of every element's load from its own slow mean.
//!
//! These are two events, and each detector is blind to the other: an object that is gone drags nothing, and one that is
//! dragged still loads the elements. Both take one vector per element, from any sensor: displacements of markers or feelers,
//! or forces of taxels; [`GraspDrag`] takes loads along the normal, too, where there are any. A vector that is not a number stands for an element that has none in that frame. Updating
//! them neither allocates nor panics; the same frames give the same numbers.
//!
//! Neither warns ahead: a loss is known when the elements are unloaded, and on purpose it looks as by accident; drag is known
//! when loads have changed. `docs/slip.md` has their scores on recordings.
//!
//! ```
//! use feeler::control::grasp_slip::{Contact, ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig};
//! use glam::{DVec2, DVec3};
//!
//! // Three elements of 1 N full scale, whose shear is known from an untouched reference, at 100 Hz.
//! let mut loss = ContactLoss::from_untouched(3, 1.0, ContactLossConfig::default())?;
//! let mut drag = GraspDrag::new(3, 0.01, GraspDragConfig::default())?;
//! for frame in 0..300 {
//!     let shear = if frame < 100 { 0.2 } else { 0.0 };
//!     loss.update(0.01, [DVec2::new(shear, 0.0); 3]);
//!     drag.update(0.01, [DVec3::new(shear, 0.0, 0.5); 3]);
//! }
//! assert_eq!(loss.contact(), Contact::Lost);
//! # Ok::<_, feeler::control::grasp_slip::GraspSlipError>(())
//! ```

mod contact_loss;
mod error;
mod grasp_drag;
mod lens_fit;
mod regular_pattern;

pub use contact_loss::{Contact, ContactLoss, ContactLossConfig};
pub use error::GraspSlipError;
pub use grasp_drag::{GraspDrag, GraspDragConfig, noise_of};
pub use regular_pattern::{FEWEST_ELEMENTS, Picture, RegularPattern};

use glam::DVec2;

/// Largest vector in units of the scale that a sensor could mean: beyond it, squares would drown everything else.
const LARGEST: f64 = 1e6;

/// The vector in units of `scale`, if it is one.
fn scaled(vector: DVec2, scale: f64) -> Option<DVec2> {
    let scaled = vector / scale;
    (scaled.x.abs() <= LARGEST && scaled.y.abs() <= LARGEST).then_some(scaled)
}

/// The part of the way to a new value that an exponential filter goes in `interval` (s): 0 where no time has passed, or it is
/// not a number.
fn part(interval: f64, time_constant: f64) -> f64 {
    match interval > 0.0 {
        true => -(-interval / time_constant).exp_m1(),
        false => 0.0,
    }
}

/// The interval, if time has passed; 0 for one that is negative or not a number, as where stamps are repeated or go back.
fn passed(interval: f64) -> f64 {
    interval.max(0.0)
}
