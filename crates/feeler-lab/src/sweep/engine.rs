//! Runs the trials that are left, on as many threads as asked for; one thread writes.

use super::SweepError;
use super::store::Store;
use super::trial::Trials;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Whether everything was run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// Every trial that was asked for is finished.
    Whole,
    /// Somebody stopped it; trials are left.
    Stopped,
}

/// Who watches a sweep.
pub trait Progress {
    /// After every finished trial: how many are finished, of how many, and how many were a success.
    fn show(&mut self, finished: u64, of: u64, successes: u64);
}

/// Runs what is left of the shard below trial `end` on `jobs` threads, until done or `stop` is raised.
/// Trials under way are dropped then.
///
/// # Errors
/// When a row cannot be written; what was written is kept.
pub fn run(
    trials: &Trials,
    store: &mut Store,
    end: u64,
    jobs: usize,
    stop: &AtomicBool,
    progress: &mut dyn Progress,
) -> Result<Ended, SweepError> {
    let plan = trials.plan();
    let mine = |trial: &u64| plan.shard.has(*trial);
    let of = (0..plan.trials).filter(mine).count() as u64;
    let left = store.missing(plan, end);
    let next = AtomicUsize::new(0);
    let given_up = AtomicBool::new(false);
    let (finished, rows) = channel();
    let (_, mut successes) = store.table.successes();
    let success = store.table.column("success");
    let work = |finished: std::sync::mpsc::Sender<(u64, Vec<String>)>| {
        while !stop.load(Ordering::Relaxed) && !given_up.load(Ordering::Relaxed) {
            let Some(&trial) = left.get(next.fetch_add(1, Ordering::Relaxed)) else {
                break;
            };
            let Some(row) = trials.run(trial, stop) else {
                break;
            };
            if finished.send((trial, row)).is_err() {
                break;
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            let finished = finished.clone();
            scope.spawn(|| work(finished));
        }
        drop(finished);
        for (trial, row) in rows {
            // Whoever stopped it may go on with the folder by now.
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let good = success.is_some_and(|column| row[column] == "1");
            if let Err(error) = store.push(trial, row) {
                given_up.store(true, Ordering::Relaxed);
                return Err(error);
            }
            successes += u64::from(good);
            progress.show(store.table.rows.len() as u64, of, successes);
        }
        Ok(())
    })?;
    let finished = |trial: &u64| store.table.rows.contains_key(trial);
    match left.iter().all(finished) {
        true => Ok(Ended::Whole),
        false => Ok(Ended::Stopped),
    }
}
