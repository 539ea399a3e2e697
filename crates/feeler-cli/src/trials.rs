//! Running many trials into a folder: what sweeps, comparisons and robustness studies have in common.

use super::CommandError;
use super::sweep::Bar;
use feeler_console::watch_for_interrupt;
use feeler_lab::sweep::store::Store;
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, engine};
use std::num::NonZero;
use std::path::Path;
use std::thread;

/// Options of every command that runs trials.
#[derive(Debug, clap::Args)]
pub struct TrialArguments {
    /// Set any value of the experiment for all trials, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Random seed; the seed of each trial follows from it.
    #[arg(long, default_value_t = 0, value_parser = crate::trials::parse_seed)]
    pub seed: u64,
    /// Number of trials at a time [default: one for each core]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Continue what was stopped, in the same folder.
    #[arg(long)]
    pub resume: bool,
}

impl TrialArguments {
    /// Number of trials at a time.
    pub fn jobs(&self) -> usize {
        jobs(self.jobs)
    }

    /// The folder of `trials`: as it was left with --resume, otherwise a new one.
    pub fn store(&self, folder: &Path, trials: &Trials) -> Result<Store, CommandError> {
        let (plan, header) = (trials.plan(), trials.header());
        Ok(match self.resume {
            true => Store::resume(folder, plan, header)?,
            false => Store::create(folder, plan, header)?,
        })
    }

    /// Runs what is left of `trials`, until done or Ctrl-C.
    pub fn run(&self, trials: &Trials, store: &mut Store) -> Result<Ended, CommandError> {
        let stop = watch_for_interrupt()?;
        let mut bar = Bar::new(store.table.rows.len() as u64);
        let end = trials.plan().trials;
        let ended = engine::run(trials, store, end, self.jobs(), &stop, &mut bar);
        bar.clear();
        Ok(ended?)
    }
}

/// How many are done at a time: as many as were asked for, otherwise one for each core.
pub fn jobs(asked: Option<u64>) -> usize {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    asked.map_or_else(cores, |jobs| jobs as usize)
}

/// A random seed: what TOML can hold of the whole numbers from 0.
pub fn parse_seed(text: &str) -> Result<u64, String> {
    let seed = text
        .parse()
        .ok()
        .filter(|&seed: &u64| seed <= i64::MAX as u64);
    seed.ok_or_else(|| format!("expected a whole number from 0 to {}", i64::MAX))
}
