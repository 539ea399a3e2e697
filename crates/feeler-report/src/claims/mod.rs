//! Claims about a run in which a cap is screwed, measured on its recording.
//!
//! [`claims`] are those of the paper, about its own law. [`of_any_hand`] are about what a user wants of a hand under any law.
//! A claim holds if all its parts hold. A part whose value the recording does not define (a stroke that was not made, too
//! few samples) does not hold, and the claim's text says so.

mod any_hand;
mod bottle;
mod hand;
mod measured;
mod parts;

pub use any_hand::of_any_hand;
pub(crate) use any_hand::{CLOSES_CAP, OVERLOADS_NOTHING};
pub use bottle::rates;
pub(crate) use hand::{NO_DAMAGE, no_damage};

use super::claim::{Claim, DecidedBy};
use super::run_data::RunData;
use super::strokes::StrokeMeasures;
use super::thinned::Pressed;
use feeler_record::RunFacts;
use measured::Measured;

/// A peak rises above this share of the run's peak…
pub(crate) const PEAK_RISES_ABOVE: f64 = 0.10;
/// …and ends when it falls below this share.
pub(crate) const PEAK_ENDS_BELOW: f64 = 0.05;
/// Length of the moving mean that goes over series before peaks are counted and before torque
/// rate and shear rate are compared, s.
pub const SMOOTHING: f64 = 0.05;
/// Share of F2 above which an element might be damaged.
pub const DAMAGE_FORCE: f64 = 1.25;

/// The claims of the paper, in its order, about a run whose strokes measure `strokes`. What needs an instrument that the rig
/// does not have is not measured.
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

/// The force (N) above which an element might be damaged.
pub(crate) fn damage_limit(facts: &RunFacts) -> f64 {
    DAMAGE_FORCE * facts.over_force_threshold
}

/// Longest time of an element pressed harder than `limit` (N), s; `None` if no forces are known.
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

/// The odd number of samples nearest to a time, at least 1.
pub(crate) fn samples(data: &RunData, time: f64) -> usize {
    let samples = (time / data.facts.control_period).round().clamp(1.0, 1e6) as usize;
    samples | 1
}
