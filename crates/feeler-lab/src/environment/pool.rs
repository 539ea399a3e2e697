//! Threads that work on the parts of something, again and again.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// For how long a thread that has nothing to do looks for work before it sleeps. To wake one takes some 50 us on a virtual
/// machine, as long as a dozen environments need for a step.
const LOOKS: Duration = Duration::from_micros(50);

/// Parts, and the threads that work on them. Dropping it ends the threads.
pub(super) struct Pool<T> {
    shared: Arc<Shared<T>>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared<T> {
    parts: Vec<Mutex<T>>,
    work: fn(&mut T),
    /// The parts of each thread, which it takes first, as they are in its processor's cache.
    shares: Vec<Share>,
    /// Parts of this round that are not finished.
    left: AtomicUsize,
    /// Number of the round; changed with `state` locked.
    round: AtomicU64,
    state: Mutex<State>,
    /// There is a new round, or none will come.
    begins: Condvar,
    /// The round's last part is finished, or a thread has come up.
    ends: Condvar,
}

/// Parts in a row, on a cache line of their own.
#[repr(align(128))]
struct Share {
    first: usize,
    end: usize,
    /// The first that nobody has taken in this round.
    next: AtomicUsize,
}

struct State {
    /// The first part that panicked, and what it said.
    panicked: Option<(usize, String)>,
    /// Threads that have come up.
    up: usize,
    /// Threads that sleep until a round begins.
    sleeping: usize,
    closing: bool,
}

impl<T: Send + 'static> Pool<T> {
    /// `threads` threads for `parts`, the caller's among them. `work` is what is done with each part in each round.
    ///
    /// # Errors
    /// When the system has no more threads.
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
        // What a thread allocates to come up is allocated by then.
        let mut state = lock(&pool.shared.state);
        while state.up < pool.threads.len() {
            state = wait(&pool.shared.ends, state);
        }
        drop(state);
        Ok(pool)
    }

    /// Works on all parts, each on whichever thread comes first. Does not allocate.
    ///
    /// # Errors
    /// The first part that panicked, and what it said; the others are finished all the same.
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

    /// The parts, between rounds.
    pub fn parts(&self) -> impl Iterator<Item = MutexGuard<'_, T>> {
        self.shared.parts.iter().map(lock)
    }
}

impl<T> Drop for Pool<T> {
    fn drop(&mut self) {
        lock(&self.shared.state).closing = true;
        self.shared.begins.notify_all();
        for thread in self.threads.drain(..) {
            // What a part panics with is told by `run`; the threads themselves do not.
            let _ = thread.join();
        }
    }
}

impl<T> Shared<T> {
    /// Begins a round: the parts are there to be taken.
    fn begin(&self) {
        // Before any part can be taken, also by a thread that still looks for parts of the round before.
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

    /// Works on the parts of thread `index`, then on others', for as long as there are some that nobody has taken.
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
            // Locked, so that nobody who has just found it unfinished misses this.
            let _state = lock(&self.state);
            self.ends.notify_all();
        }
    }
}

/// Whether `it_is` within [`LOOKS`].
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

/// A panic elsewhere does not lock anything for good.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn wait<'a, T>(condition: &Condvar, guard: MutexGuard<'a, T>) -> MutexGuard<'a, T> {
    condition
        .wait(guard)
        .unwrap_or_else(PoisonError::into_inner)
}

/// What a panic said.
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
    fn every_part_is_worked_on_once_in_each_round() {
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
    fn threads_that_went_to_sleep_between_rounds_are_woken() {
        let pool = Pool::new(vec![100; 6], 3, count).unwrap();
        for round in 1..5 {
            thread::sleep(4 * LOOKS);
            assert_eq!(pool.run(), Ok(()));
            assert_eq!(values(&pool), [100 + round; 6]);
        }
    }

    /// A thread that is through with its own parts takes another's: else this would not end.
    #[test]
    fn parts_of_a_thread_that_is_busy_are_taken_by_another() {
        type Part = (usize, Arc<(Mutex<bool>, Condvar)>);
        // Both are the first thread's: part 0 waits for part 1.
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
    fn a_part_that_panics_is_told_of_and_the_others_go_on() {
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
