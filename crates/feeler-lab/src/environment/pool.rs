//! A thread pool that repeatedly applies a function to a fixed set of parts.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Time for which an idle thread spins before it sleeps. Waking a thread takes about 50 us on a virtual machine, as
/// long as a step of a dozen environments.
const LOOKS: Duration = Duration::from_micros(50);

/// The parts and the threads that work on them. The threads end when the pool is dropped.
pub(super) struct Pool<T> {
    shared: Arc<Shared<T>>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared<T> {
    parts: Vec<Mutex<T>>,
    work: fn(&mut T),
    /// Parts assigned to each thread, which works on them first because they are in its processor's cache.
    shares: Vec<Share>,
    /// Number of unfinished parts in this round.
    left: AtomicUsize,
    /// Number of the round; changed with `state` locked.
    round: AtomicU64,
    state: Mutex<State>,
    /// Signals a new round or the end of the pool.
    begins: Condvar,
    /// Signals that the last part of the round is finished, or that a thread has started.
    ends: Condvar,
}

/// Range of part indices assigned to one thread, aligned so that no two shares are in the same cache line.
#[repr(align(128))]
struct Share {
    first: usize,
    end: usize,
    /// Index of the first part not yet taken in this round.
    next: AtomicUsize,
}

struct State {
    /// Index and message of the first part that panicked.
    panicked: Option<(usize, String)>,
    /// Number of started threads.
    up: usize,
    /// Number of threads that sleep until the next round.
    sleeping: usize,
    closing: bool,
}

impl<T: Send + 'static> Pool<T> {
    /// Creates a pool of `threads` threads, including the caller's, that applies `work` to each part in each round.
    ///
    /// # Errors
    /// If the system cannot create the threads.
    pub fn new(parts: Vec<T>, threads: usize, work: fn(&mut T)) -> std::io::Result<Self> {
        let (count, threads) = (parts.len(), threads.max(1));
        let share = |index| Share {
            first: index * count / threads,
            end: (index + 1) * count / threads,
            next: AtomicUsize::new(count),
        };
        let shared = Arc::new(Shared {
            parts: parts.into_iter().map(Mutex::new).collect(),
            work,
            shares: (0..threads).map(share).collect(),
            left: AtomicUsize::new(0),
            round: AtomicU64::new(0),
            state: Mutex::new(State {
                panicked: None,
                up: 0,
                sleeping: 0,
                closing: false,
            }),
            begins: Condvar::new(),
            ends: Condvar::new(),
        });
        let mut pool = Self {
            threads: Vec::with_capacity(threads),
            shared,
        };
        for index in 1..threads {
            let shared = Arc::clone(&pool.shared);
            let thread = thread::Builder::new().name(format!("environments-{index}"));
            pool.threads
                .push(thread.spawn(move || shared.serve(index))?);
        }
        // Wait until all threads have started, so that their allocations at startup are done.
        let mut state = lock(&pool.shared.state);
        while state.up < pool.threads.len() {
            state = wait(&pool.shared.ends, state);
        }
        drop(state);
        Ok(pool)
    }

    /// Runs one round: applies the function to each part, on any thread. Does not allocate.
    ///
    /// # Errors
    /// Index and message of the first part that panicked. The other parts are finished nevertheless.
    pub fn run(&self) -> Result<(), (usize, String)> {
        let shared = &*self.shared;
        shared.begin();
        shared.take_parts(0);
        let is_over = || shared.left.load(Ordering::Acquire) == 0;
        let over = soon(is_over);
        let mut state = lock(&shared.state);
        while !over && !is_over() {
            state = wait(&shared.ends, state);
        }
        state.panicked.take().map_or(Ok(()), Err)
    }

    /// Iterates over the parts, between rounds.
    pub fn parts(&self) -> impl Iterator<Item = MutexGuard<'_, T>> {
        self.shared.parts.iter().map(lock)
    }
}

impl<T> Drop for Pool<T> {
    fn drop(&mut self) {
        lock(&self.shared.state).closing = true;
        self.shared.begins.notify_all();
        for thread in self.threads.drain(..) {
            // Panics of parts are returned by `run`; the threads themselves do not panic.
            let _ = thread.join();
        }
    }
}

impl<T> Shared<T> {
    /// Starts a round: makes all parts available and wakes sleeping threads.
    fn begin(&self) {
        // Must precede the release of the parts, as a thread may still be looking for parts of the previous round.
        self.left.store(self.parts.len(), Ordering::Relaxed);
        for share in &self.shares {
            share.next.store(share.first, Ordering::Release);
        }
        let state = lock(&self.state);
        self.round.fetch_add(1, Ordering::Release);
        if state.sleeping > 0 {
            self.begins.notify_all();
        }
    }

    fn serve(&self, index: usize) {
        let mut seen = 0;
        let mut state = lock(&self.state);
        state.up += 1;
        self.ends.notify_all();
        while !state.closing {
            let newest = self.round.load(Ordering::Acquire);
            if newest == seen {
                state.sleeping += 1;
                state = wait(&self.begins, state);
                state.sleeping -= 1;
                continue;
            }
            drop(state);
            seen = newest;
            self.take_parts(index);
            soon(|| self.round.load(Ordering::Acquire) != seen);
            state = lock(&self.state);
        }
    }

    /// Works on the parts of thread `index`, then on those of other threads, until all parts are taken.
    fn take_parts(&self, index: usize) {
        let (before, own) = self.shares.split_at(index);
        for share in own.iter().chain(before) {
            loop {
                let part = share.next.fetch_add(1, Ordering::AcqRel);
                if part >= share.end {
                    break;
                }
                self.work_on(part);
            }
        }
    }

    fn work_on(&self, index: usize) {
        let part = &self.parts[index];
        let worked = catch_unwind(AssertUnwindSafe(|| (self.work)(&mut lock(part))));
        if let Err(panic) = worked {
            let panicked = &mut lock(&self.state).panicked;
            if panicked.as_ref().is_none_or(|(first, _)| index < *first) {
                *panicked = Some((index, words(&*panic)));
            }
        }
        if self.left.fetch_sub(1, Ordering::AcqRel) == 1 {
            // Locked so that a caller that has just found the round unfinished does not miss the notification.
            let _state = lock(&self.state);
            self.ends.notify_all();
        }
    }
}

/// Spins until `it_is` returns `true`, for at most [`LOOKS`]. Returns `true` if it did.
fn soon(it_is: impl Fn() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < LOOKS {
        for _ in 0..16 {
            if it_is() {
                return true;
            }
            std::hint::spin_loop();
        }
    }
    it_is()
}

/// Locks a mutex and ignores poisoning, because panics are reported separately.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn wait<'a, T>(condition: &Condvar, guard: MutexGuard<'a, T>) -> MutexGuard<'a, T> {
    condition
        .wait(guard)
        .unwrap_or_else(PoisonError::into_inner)
}

/// Returns the message of a panic.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "no message".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(part: &mut u32) {
        assert!(*part != 13, "thirteen");
        *part += 1;
    }

    fn values(pool: &Pool<u32>) -> Vec<u32> {
        pool.parts().map(|part| *part).collect()
    }

    #[test]
    fn every_part_is_processed_once_per_round() {
        for threads in [0, 1, 2, 7] {
            let pool = Pool::new(vec![100; 5], threads, count).unwrap();
            for round in 1..50 {
                assert_eq!(pool.run(), Ok(()));
                assert_eq!(values(&pool), [100 + round; 5]);
            }
        }
        assert_eq!(Pool::new(Vec::new(), 2, count).unwrap().run(), Ok(()));
    }

    #[test]
    fn sleeping_threads_are_woken() {
        let pool = Pool::new(vec![100; 6], 3, count).unwrap();
        for round in 1..5 {
            thread::sleep(4 * LOOKS);
            assert_eq!(pool.run(), Ok(()));
            assert_eq!(values(&pool), [100 + round; 6]);
        }
    }

    /// A thread that has finished its parts takes those of another; otherwise this test would not end.
    #[test]
    fn parts_of_a_busy_thread_are_taken_by_another() {
        type Part = (usize, Arc<(Mutex<bool>, Condvar)>);
        // Both parts are assigned to the first thread: part 0 waits for part 1.
        fn work((index, after): &mut Part) {
            let (is_done, changes) = &**after;
            let mut done = lock(is_done);
            *done |= *index == 1;
            changes.notify_all();
            while *index == 0 && !*done {
                done = wait(changes, done);
            }
        }
        let after = Arc::default();
        let parts = (0..4).map(|index| (index, Arc::clone(&after)));
        let pool = Pool::new(parts.collect(), 2, work).unwrap();
        assert_eq!(pool.run(), Ok(()));
    }

    #[test]
    fn dropping_a_pool_ends_its_threads() {
        let part = Arc::new(());
        let pool = Pool::new(vec![Arc::clone(&part); 3], 3, |_| {}).unwrap();
        assert_eq!(pool.run(), Ok(()));
        drop(pool);
        assert_eq!(Arc::strong_count(&part), 1);
    }

    #[test]
    fn a_panic_is_reported_and_the_other_parts_are_finished() {
        for threads in [1, 3] {
            let pool = Pool::new(vec![20, 12, 30], threads, count).unwrap();
            assert_eq!(pool.run(), Ok(()));
            for round in 2..4 {
                assert_eq!(pool.run(), Err((1, "thirteen".to_string())));
                assert_eq!(values(&pool), [20 + round, 13, 30 + round]);
            }
        }
    }
}
