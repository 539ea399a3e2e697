//! Time limits for closing a recording.

use super::options::Backpressure;
use std::time::{Duration, Instant};

/// Maximum time to close the file of a recording that must not block its run ([`Backpressure::Limited`]).
pub const CLOSE_TIMEOUT: Duration = Duration::from_secs(5);

/// Time after which `on_slow` is called.
const SLOW: Duration = Duration::from_secs(1);

/// Progress of closing a recording.
pub struct CloseDeadline<'a> {
    start: Instant,
    limit: Option<Duration>,
    /// Called once if closing is slow.
    on_slow: Option<Box<dyn FnOnce() + 'a>>,
}

impl<'a> CloseDeadline<'a> {
    /// Starts closing with a time limit. Calls `on_slow` after one second.
    pub fn within(limit: Duration, on_slow: impl FnOnce() + 'a) -> Self {
        Self {
            start: Instant::now(),
            limit: Some(limit),
            on_slow: Some(Box::new(on_slow)),
        }
    }

    /// Starts the time limit for closing a recording with this back-pressure.
    pub fn of(patience: Backpressure) -> Self {
        Self {
            start: Instant::now(),
            limit: match patience {
                Backpressure::Unlimited => None,
                Backpressure::Limited(_) => Some(CLOSE_TIMEOUT),
            },
            on_slow: None,
        }
    }

    /// Returns `false` once the time limit is exceeded. Calls `on_slow` when closing becomes slow.
    pub fn goes_on(&mut self) -> bool {
        let elapsed = self.start.elapsed();
        if elapsed >= SLOW
            && let Some(on_slow) = self.on_slow.take()
        {
            on_slow();
        }
        self.limit.is_none_or(|limit| elapsed < limit)
    }

    /// The time limit.
    pub fn limit(&self) -> Duration {
        self.limit.unwrap_or(Duration::MAX)
    }
}
