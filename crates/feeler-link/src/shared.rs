//! What a thread of the network's fills and the program's own thread waits for.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Something that several threads share. A panic in one does not lock it for good.
#[derive(Debug)]
pub struct Shared<T>(Arc<Inner<T>>);

#[derive(Debug)]
struct Inner<T> {
    value: Mutex<T>,
    change: Condvar,
    /// How many wait for a change. To wake nobody costs a call of the system's, too, and a hand that keeps its own period waits for no message.
    waiting: AtomicUsize,
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Shared<T> {
    /// Shares `value`.
    pub fn new(value: T) -> Self {
        Self(Arc::new(Inner {
            value: Mutex::new(value),
            change: Condvar::new(),
            waiting: AtomicUsize::new(0),
        }))
    }

    /// The value, for as long as the guard lives.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let locked = self.0.value.lock();
        locked.unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes who waits for a change, which was made under the lock before.
    pub fn changed(&self) {
        // Who waits counted himself under the lock before he looked. So he is seen here, or he has seen the change.
        if self.0.waiting.load(Ordering::Relaxed) > 0 {
            self.0.change.notify_all();
        }
    }

    /// Waits until `ready` says so after a change, for at most `longest`; whether it did.
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
    fn each_change_reaches_who_waits() {
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
        // A change that nobody was told of would take 20 s.
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
