//! Claims about a cap-screwing run, measured on its recording.
//!
//! [`claims`] returns the paper's claims about its own law. [`of_any_hand`] returns claims that apply under any law. A
//! claim holds if all its parts hold. If the recording does not define a value (missing stroke, too few samples), its
//! part does not hold, and the claim's text names it.

pub(crate) mod any_hand;
mod bottle;
pub(crate) mod hand;
mod measured;
mod parts;

pub use crate::measures::overload::DAMAGE_FORCE;
pub use crate::measures::smoothing::SMOOTHING;
pub use any_hand::of_any_hand;
pub use bottle::rates;

use crate::measures::claim::Claim;
use crate::measures::claim::DecidedBy::{Hand, HandAndBottle};
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use measured::Measured;

/// The paper's claims, in the order of the paper, for a run with these stroke measures. Claims that need a missing
/// instrument are reported as not measured.
pub fn claims(data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
    let measured = Measured::new(data, strokes);
    let claims = [
        (HandAndBottle, bottle::four_peaks(data)),
        (HandAndBottle, bottle::first_stroke_torque_rises(data)),
        (Hand, hand::closed_after_third(&measured)),
        (Hand, hand::shear_rate_marks_closing(&measured)),
        (HandAndBottle, bottle::bumps_in_step(data)),
        (Hand, hand::slip_means_slip(data)),
        (Hand, hand::path_follows_contour(&measured)),
        (Hand, hand::path_is_curved(&measured)),
        (Hand, hand::grip_levels_off(data)),
        (Hand, hand::path_saturates(&measured)),
        (Hand, hand::no_damage(data)),
    ];
    let decided = claims.map(|(decided_by, claim)| claim.decided_by(decided_by));
    decided.into()
}
