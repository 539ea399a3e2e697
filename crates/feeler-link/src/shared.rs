//! What a thread of the network's fills and the program's own thread waits for.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Something that several threads share. A panic in one does not lock it for good.
#[derive(Debug)]
pub struct Shared<T>(Arc<(Mutex<T>, Condvar)>);

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Shared<T> {
    /// Shares `value`.
    pub fn new(value: T) -> Self {
        Self(Arc::new((Mutex::new(value), Condvar::new())))
    }

    /// The value, for as long as the guard lives.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes who waits for a change.
    pub fn changed(&self) {
        self.0.1.notify_all();
    }

    /// Waits until `ready` says so after a change, for at most `longest`; whether it did.
    pub fn wait_for(&self, longest: Duration, mut ready: impl FnMut(&mut T) -> bool) -> bool {
        let end = Instant::now() + longest;
        let mut value = self.lock();
        while !ready(&mut value) {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            let waited = self.0.1.wait_timeout(value, left);
            value = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        true
    }
}
