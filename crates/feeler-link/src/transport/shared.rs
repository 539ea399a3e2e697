//! Value shared between the network's threads and the program's thread, with change notification.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Mutex with change notification, shared by reference counting. Ignores poisoning.
#[derive(Debug)]
pub struct Shared<T>(Arc<Inner<T>>);

#[derive(Debug)]
struct Inner<T> {
    value: Mutex<T>,
    change: Condvar,
    /// Number of threads waiting for a change. It is usually 0 for a hand with a fixed period; a notification then
    /// skips the system call.
    waiting: AtomicUsize,
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Shared<T> {
    /// Creates a shared value.
    pub fn new(value: T) -> Self {
        Self(Arc::new(Inner {
            value: Mutex::new(value),
            change: Condvar::new(),
            waiting: AtomicUsize::new(0),
        }))
    }

    /// Locks the value.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let locked = self.0.value.lock();
        locked.unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes all waiting threads. Call this after a change made under the lock.
    pub fn changed(&self) {
        // A waiting thread counts itself under the lock before it checks the value, so it is either counted here or has
        // already seen the change.
        if self.0.waiting.load(Ordering::Relaxed) > 0 {
            self.0.change.notify_all();
        }
    }

    /// Waits until `ready` returns `true`, checking after each change. Returns `false` after the timeout `longest`.
    pub fn wait_for(&self, longest: Duration, mut ready: impl FnMut(&mut T) -> bool) -> bool {
        let end = Instant::now() + longest;
        let mut value = self.lock();
        self.0.waiting.fetch_add(1, Ordering::Relaxed);
        let is_ready = loop {
            if ready(&mut value) {
                break true;
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break false;
            }
            let waited = self.0.change.wait_timeout(value, left);
            value = waited.unwrap_or_else(PoisonError::into_inner).0;
        };
        self.0.waiting.fetch_sub(1, Ordering::Relaxed);
        is_ready
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn each_change_wakes_the_waiting_thread() {
        let (ping, pong) = (Shared::new(0), Shared::new(0));
        let (heard, answer) = (ping.clone(), pong.clone());
        let answers = thread::spawn(move || {
            for round in 1..=10_000 {
                if !heard.wait_for(Duration::from_secs(20), |at| *at == round) {
                    return false;
                }
                *answer.lock() = round;
                answer.changed();
            }
            true
        });
        let start = Instant::now();
        for round in 1..=10_000 {
            *ping.lock() = round;
            ping.changed();
            assert!(pong.wait_for(Duration::from_secs(20), |at| *at == round));
        }
        assert!(answers.join().unwrap());
        // A missed notification would take 20 s.
        assert!(start.elapsed() < Duration::from_secs(20));
        assert_eq!(ping.0.waiting.load(Ordering::Relaxed), 0);
    }

    #[test]
    fn a_wait_ends_without_a_change() {
        let shared = Shared::new(false);
        assert!(!shared.wait_for(Duration::from_millis(1), |at| *at));
        assert_eq!(shared.0.waiting.load(Ordering::Relaxed), 0);
    }
}
