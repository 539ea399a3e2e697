//! Runs the unfinished trials of a sweep on several threads, with one thread that writes the results.

use super::SweepError;
use super::trial::Trials;
use crate::sweep::results::store::Store;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Result of running a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All requested trials are finished.
    Whole,
    /// The sweep was stopped before all trials were finished.
    Stopped,
}

/// Receives the progress of a sweep.
pub trait Progress {
    /// Called after every finished trial with the number of finished trials, their total, and the number of successes.
    fn show(&mut self, finished: u64, of: u64, successes: u64);
}

/// Runs the unfinished trials of the shard below number `end` on `jobs` threads, until all are done or `stop` is set.
/// Trials that are running when `stop` is set are discarded.
///
/// # Errors
/// If a row cannot be written. Rows written before are kept.
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
            // After a stop, another process may already be using the folder.
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
