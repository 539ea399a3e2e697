//! Force on an element above which it may be damaged.

use crate::run::data::RunData;
use crate::run::thinned::Pressed;
use feeler_record::RunFacts;

/// Force relative to F2 above which an element may be damaged.
pub const DAMAGE_FORCE: f64 = 1.25;
/// Maximum time for which an element may exceed its damage limit (s).
pub const DAMAGE_TIME: f64 = 0.05;

/// Force above which an element may be damaged (N).
pub fn damage_limit(facts: &RunFacts) -> f64 {
    DAMAGE_FORCE * facts.over_force_threshold
}

/// Longest time for which an element's force exceeds `limit` (N), in seconds; `None` if no forces are known.
pub fn longest_above(data: &RunData, limit: f64) -> Option<f64> {
    let longest = match &data.thinned {
        Some(thinned) => thinned.longest_above(limit),
        None => {
            let mut pressed = Pressed::new(limit, data.fingers.len());
            for row in 0..data.time.len() {
                pressed.take_row(&data.fingers, row);
            }
            pressed.longest()
        }
    };
    longest.map(|rows| rows as f64 * data.facts.control_period)
}
