//! How far a search goes.

use crate::control::stop_reason::StopReason;

/// Gives up a search that has come further than `limit`, m, without finding anything.
///
/// # Errors
/// When `travel` is more than `limit`.
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
