//! How long closing a recording may take.

use super::options::Patience;
use std::time::{Duration, Instant};

/// How long a file that takes nothing may hold up the end of a run that does not wait for it.
pub const CLOSE_LIMIT: Duration = Duration::from_secs(5);

/// After this it is worth saying.
const SLOW: Duration = Duration::from_secs(1);

/// The closing of a recording.
pub struct Closing<'a> {
    start: Instant,
    limit: Option<Duration>,
    /// To be called once, when it takes long.
    on_slow: Option<Box<dyn FnOnce() + 'a>>,
}

impl<'a> Closing<'a> {
    /// Begins now and takes at most `limit`. When it takes more than a second, `on_slow` is called.
    pub fn within(limit: Duration, on_slow: impl FnOnce() + 'a) -> Self {
        Self {
            start: Instant::now(),
            limit: Some(limit),
            on_slow: Some(Box::new(on_slow)),
        }
    }

    /// Begins now and takes as long as a recording of this patience may.
    pub fn of(patience: Patience) -> Self {
        Self {
            start: Instant::now(),
            limit: match patience {
                Patience::Unlimited => None,
                Patience::Limited(_) => Some(CLOSE_LIMIT),
            },
            on_slow: None,
        }
    }

    /// Whether to go on waiting.
    pub fn goes_on(&mut self) -> bool {
        let elapsed = self.start.elapsed();
        if elapsed >= SLOW
            && let Some(on_slow) = self.on_slow.take()
        {
            on_slow();
        }
        self.limit.is_none_or(|limit| elapsed < limit)
    }

    /// How long it may take.
    pub fn limit(&self) -> Duration {
        self.limit.unwrap_or(Duration::MAX)
    }
}
