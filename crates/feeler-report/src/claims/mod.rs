//! Claims about a cap-screwing run, measured on its recording.
//!
//! [`claims`] returns the paper's claims about its own law. [`of_any_hand`] returns claims that apply under any law. A
//! claim holds if all its parts hold. If the recording does not define a value (missing stroke, too few samples), its
//! part does not hold, and the claim's text names it.

mod any_hand;
mod bottle;
mod hand;
mod measured;
mod parts;

pub use any_hand::of_any_hand;
pub(crate) use any_hand::{CLOSES_CAP, OVERLOADS_NOTHING};
pub use bottle::rates;
pub(crate) use hand::{NO_DAMAGE, no_damage};

use crate::measures::claim::{Claim, DecidedBy};
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use crate::run::thinned::Pressed;
use feeler_record::RunFacts;
use measured::Measured;

/// Fraction of the run's maximum that a signal must exceed to start a peak.
pub(crate) const PEAK_RISES_ABOVE: f64 = 0.10;
/// Fraction of the run's maximum below which a peak ends.
pub(crate) const PEAK_ENDS_BELOW: f64 = 0.05;
/// Length of the moving mean applied before peaks are counted and before torque rate and shear rate are compared (s).
pub const SMOOTHING: f64 = 0.05;
/// Force relative to F2 above which an element may be damaged.
pub const DAMAGE_FORCE: f64 = 1.25;

/// The paper's claims, in its order, for a run with these stroke measures. Claims that need a missing instrument are
/// reported as not measured.
pub fn claims(data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
    let measured = Measured::new(data, strokes);
    vec![
        bottle::four_peaks(data),
        bottle::first_stroke_torque_rises(data),
        hand::closed_after_third(&measured),
        hand::shear_rate_marks_closing(&measured),
        bottle::bumps_in_step(data),
        hand::slip_means_slip(data),
        hand::path_follows_contour(&measured),
        hand::path_is_curved(&measured),
        hand::grip_levels_off(data),
        hand::path_saturates(&measured),
        no_damage(data).decided_by(DecidedBy::Hand),
    ]
}

/// Force above which an element may be damaged (N).
pub(crate) fn damage_limit(facts: &RunFacts) -> f64 {
    DAMAGE_FORCE * facts.over_force_threshold
}

/// Longest time for which an element's force exceeds `limit` (N), in seconds; `None` if no forces are known.
pub(crate) fn longest_above(data: &RunData, limit: f64) -> Option<f64> {
    let longest = match &data.thinned {
        Some(thinned) => thinned.longest_above(limit),
        None => {
            let mut pressed = Pressed::new(limit, data.fingers.len());
            for row in 0..data.time.len() {
                pressed.take_row(data, row);
            }
            pressed.longest()
        }
    };
    longest.map(|rows| rows as f64 * data.facts.control_period)
}

/// Odd number of samples closest to a duration (s), at least 1.
pub(crate) fn samples(data: &RunData, time: f64) -> usize {
    let samples = (time / data.facts.control_period).round().clamp(1.0, 1e6) as usize;
    samples | 1
}
