//! Slip of a grasped object that moves with the hand.
//!
//! The detectors for objects at rest ([`FlagAnalyzer`](super::flags::FlagAnalyzer),
//! [`SlipDetector`](super::slip_detector::SlipDetector)) derive slip from the shear rate or from the fingertip's own
//! motion. In a grasp that is lifted, carried and shaken, shear changes without any slip, and the object moves with
//! the fingertip. Two events can be detected there from the elements' displacements or shears alone:
//!
//! - [`ContactLoss`]: *Is the object still held?* Uses the load on the elements relative to their untouched state, or
//!   relative to a [`RegularPattern`] seen through a lens if that state is unknown.
//! - [`GraspDrag`]: *Does the object move within the grip?* Uses the deviation of every element's load from its own
//!   slow mean.
//!
//! - [`ImageLoss`]: *Is the object still held?* Uses the image of the gel relative to the one of the untouched gel.
//!
//! Each detector misses the other event: a lost object no longer drags the elements, and a dragged object still loads
//! them. Both take one vector per element from any sensor: displacements of markers or feelers, or forces of taxels.
//! [`GraspDrag`] also uses normal loads, if available. A NaN vector marks an element without a measurement in that
//! frame. Updates neither allocate nor panic, and the same frames give the same results.
//!
//! Neither detector predicts slip. A loss is detected once the elements are unloaded, whether on purpose or by
//! accident; drag is detected once loads have changed. `docs/slip.md` lists their scores on recordings.
//!
//! ```
//! use feeler::control::grasp_slip::{Contact, ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig};
//! use glam::{DVec2, DVec3};
//!
//! // Three elements of 1 N full scale, whose shear is relative to an untouched reference, at 100 Hz.
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
mod image_loss;
mod lens_fit;
mod regular_pattern;

pub use contact_loss::{Contact, ContactLoss, ContactLossConfig};
pub use error::GraspSlipError;
pub use grasp_drag::{GraspDrag, GraspDragConfig, noise_of};
pub use image_loss::{CoarseImage, ImageLoss};
pub use regular_pattern::{FEWEST_ELEMENTS, Picture, RegularPattern};

use glam::DVec2;

/// Maximum valid magnitude of a vector, in units of the scale. Larger vectors are rejected, because their squares would
/// dominate the sums.
const LARGEST: f64 = 1e6;

/// The vector in units of `scale`, or `None` if it is NaN or implausibly large.
fn scaled(vector: DVec2, scale: f64) -> Option<DVec2> {
    let scaled = vector / scale;
    (scaled.x.abs() <= LARGEST && scaled.y.abs() <= LARGEST).then_some(scaled)
}

/// Weight of a new value in an exponential filter after `interval` (s); 0 if the interval is not positive.
pub(in crate::control) fn part(interval: f64, time_constant: f64) -> f64 {
    match interval > 0.0 {
        true => -libm::expm1(-interval / time_constant),
        false => 0.0,
    }
}

/// Returns the interval, or 0 if it is negative or NaN, as for repeated or decreasing stamps.
fn passed(interval: f64) -> f64 {
    interval.max(0.0)
}
