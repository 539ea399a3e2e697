//! Arguments and functions shared by the commands that run trials: sweeps, comparisons, robustness studies.

use crate::CommandError;
use feeler_console::{Bar, watch_for_interrupt};
use feeler_lab::sweep::results::Store;
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Progress, engine};
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Instant;

/// Options of every command that runs trials.
#[derive(Debug, clap::Args)]
pub struct TrialArguments {
    /// Override an experiment value in all trials, e.g. control.slip_threshold=2.5. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Random seed, from which the seed of each trial is derived.
    #[arg(long, default_value_t = 0, value_parser = crate::experiments::trials::parse_seed)]
    pub seed: u64,
    /// Number of trials to run in parallel [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Continue an interrupted run in the same folder.
    #[arg(long)]
    pub resume: bool,
}

impl TrialArguments {
    /// Returns the number of parallel trials.
    pub fn jobs(&self) -> usize {
        jobs(self.jobs)
    }

    /// Opens the folder of `trials`: the existing one with --resume, otherwise a new one.
    pub fn store(&self, folder: &Path, trials: &Trials) -> Result<Store, CommandError> {
        let (plan, header) = (trials.plan(), trials.header());
        Ok(match self.resume {
            true => Store::resume(folder, plan, header)?,
            false => Store::create(folder, plan, header)?,
        })
    }

    /// Runs the remaining `trials` until done or Ctrl-C.
    pub fn run(&self, trials: &Trials, store: &mut Store) -> Result<Ended, CommandError> {
        let stop = watch_for_interrupt()?;
        let mut bar = TrialsBar::new(store.table.rows.len() as u64);
        let (end, jobs) = (trials.plan().trials, self.jobs());
        Ok(engine::run(trials, store, end, jobs, &stop, &mut bar)?)
    }
}

/// Returns the requested number of parallel jobs, by default the number of cores.
pub fn jobs(asked: Option<u64>) -> usize {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    asked.map_or_else(cores, |jobs| jobs as usize)
}

/// Calls `work` with each number below `count` on `jobs` threads, until all are started or `interrupted` is set, and
/// `receive` with each number and result on this thread, in order of completion.
///
/// # Errors
/// If `receive` fails. Results of running calls are discarded then.
pub fn in_parallel<T: Send, E>(
    count: u64,
    jobs: usize,
    interrupted: &AtomicBool,
    work: impl Fn(u64) -> T + Sync,
    mut receive: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    let (next, work) = (&AtomicU64::new(0), &work);
    thread::scope(|scope| {
        let (finished, results) = channel();
        for _ in 0..jobs {
            let finished = finished.clone();
            scope.spawn(move || {
                while !interrupted.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= count || finished.send((number, work(number))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(finished);
        let mut results = results.into_iter();
        results.try_for_each(|(number, result)| receive(number, result))
    })
}

/// Returns the seed of trial `number` under the random `seed`. Different random seeds share no trials.
pub fn trial_seed(seed: u64, number: u64) -> u64 {
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(number)
}

/// Parses a random seed: a non-negative integer that TOML can represent.
pub fn parse_seed(text: &str) -> Result<u64, String> {
    let seed = text
        .parse()
        .ok()
        .filter(|&seed: &u64| seed <= i64::MAX as u64);
    seed.ok_or_else(|| format!("expected a whole number from 0 to {}", i64::MAX))
}

/// Format of a progress bar over trials.
pub(super) const TRIALS_BAR: &str = "{bar:32} {pos}/{len} trials, {msg}, {eta} left";

/// Progress bar over trials.
struct TrialsBar {
    bar: Bar,
    start: Instant,
    before: u64,
}

impl TrialsBar {
    /// Creates a bar that starts with `before` finished trials.
    fn new(before: u64) -> Self {
        let bar = Bar::new(0, TRIALS_BAR);
        bar.set_position(before);
        bar.reset_eta();
        Self {
            bar,
            start: Instant::now(),
            before,
        }
    }
}

impl Progress for TrialsBar {
    fn show(&mut self, finished: u64, of: u64, successes: u64) {
        self.bar.set_length(of);
        self.bar.set_position(finished);
        let rate = (finished - self.before) as f64 / self.start.elapsed().as_secs_f64();
        let share = 100.0 * successes as f64 / finished as f64;
        self.bar
            .set_message(format!("{share:.1} % success, {rate:.1} trials/s"));
    }
}
