//! Limit of the travel of a search.

use crate::control::stop_reason::StopReason;

/// Checks that a searching finger has not exceeded its maximum travel.
///
/// # Errors
/// If `travel` is more than `limit` (m).
pub fn check_search(finger: usize, travel: f64, limit: f64) -> Result<(), StopReason> {
    if travel > limit {
        return Err(StopReason::NothingToGrasp {
            finger,
            travel,
            limit,
        });
    }
    Ok(())
}
