//! Threads that work on the parts of something, again and again.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Parts, and the threads that work on them. Dropping it ends the threads.
pub(super) struct Pool<T> {
    shared: Arc<Shared<T>>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared<T> {
    parts: Vec<Mutex<T>>,
    work: fn(&mut T),
    round: Mutex<Round>,
    /// There is a new round, or none will come.
    begins: Condvar,
    /// The round's last part is finished, or a thread has come up.
    ends: Condvar,
}

/// Once through all parts.
struct Round {
    /// The first part that nobody has taken.
    next: usize,
    /// Parts that are not finished.
    left: usize,
    /// The first part that panicked, and what it said.
    panicked: Option<(usize, String)>,
    /// Threads that have come up.
    up: usize,
    closing: bool,
}

impl<T: Send + 'static> Pool<T> {
    /// `threads` threads for `parts`, the caller's among them. `work` is what is done with each part in each round.
    ///
    /// # Errors
    /// When the system has no more threads.
    pub fn new(parts: Vec<T>, threads: usize, work: fn(&mut T)) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            round: Mutex::new(Round {
                next: parts.len(),
                left: 0,
                panicked: None,
                up: 0,
                closing: false,
            }),
            parts: parts.into_iter().map(Mutex::new).collect(),
            work,
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
            pool.threads.push(thread.spawn(move || shared.serve())?);
        }
        // What a thread allocates to come up is allocated by then.
        let mut round = lock(&pool.shared.round);
        while round.up < pool.threads.len() {
            round = wait(&pool.shared.ends, round);
        }
        drop(round);
        Ok(pool)
    }

    /// Works on all parts, each on whichever thread comes first. Does not allocate.
    ///
    /// # Errors
    /// The first part that panicked, and what it said; the others are finished all the same.
    pub fn run(&self) -> Result<(), (usize, String)> {
        let shared = &*self.shared;
        let mut round = lock(&shared.round);
        (round.next, round.left) = (0, shared.parts.len());
        shared.begins.notify_all();
        round = shared.take_parts(round);
        while round.left > 0 {
            round = wait(&shared.ends, round);
        }
        round.panicked.take().map_or(Ok(()), Err)
    }

    /// The parts, between rounds.
    pub fn parts(&self) -> impl Iterator<Item = MutexGuard<'_, T>> {
        self.shared.parts.iter().map(lock)
    }
}

impl<T> Drop for Pool<T> {
    fn drop(&mut self) {
        lock(&self.shared.round).closing = true;
        self.shared.begins.notify_all();
        for thread in self.threads.drain(..) {
            // What a part panics with is told by `run`; the threads themselves do not.
            let _ = thread.join();
        }
    }
}

impl<T> Shared<T> {
    fn serve(&self) {
        let mut round = lock(&self.round);
        round.up += 1;
        self.ends.notify_all();
        while !round.closing {
            round = self.take_parts(round);
            if !round.closing {
                round = wait(&self.begins, round);
            }
        }
    }

    /// Works on parts for as long as there are some that nobody has taken.
    fn take_parts<'a>(&'a self, mut round: MutexGuard<'a, Round>) -> MutexGuard<'a, Round> {
        while let Some(part) = self.parts.get(round.next) {
            let index = round.next;
            round.next += 1;
            drop(round);
            let worked = catch_unwind(AssertUnwindSafe(|| (self.work)(&mut lock(part))));
            round = lock(&self.round);
            if let Err(panic) = worked {
                round
                    .panicked
                    .get_or_insert_with(|| (index, words(&*panic)));
            }
            round.left -= 1;
            if round.left == 0 {
                self.ends.notify_all();
            }
        }
        round
    }
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
