//! Wall clock of this computer.

use std::time::{SystemTime, UNIX_EPOCH};

/// Wall-clock time (ns since 1970).
pub(crate) fn wall_clock_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
    })
}
