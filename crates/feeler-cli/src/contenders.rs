//! Control laws on the same trials: a sweep for each, in a folder of the law's name.

use super::CommandError;
use super::trials::TrialArguments;
use feeler::control::law::LawConfig;
use feeler_console::watch_for_interrupt;
use feeler_lab::config::Experiment;
use feeler_lab::sweep::plan::PLAN;
use feeler_lab::sweep::store::Store;
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Plan, Progress, engine};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;

/// Trials of one law before it is the next law's turn, so that what is stopped has the same trials of all.
const BLOCK: u64 = 32;

/// One law with its sweep.
pub struct Contender {
    /// Name of the law and of its folder.
    pub name: String,
    /// The law.
    pub law: LawConfig,
    /// Its trials.
    pub trials: Trials,
    /// Their rows.
    pub store: Store,
}

/// Loads the experiment `name` with `settings` under `law`: as the experiment has it if that is the law it chooses,
/// otherwise as it comes.
pub fn under_law(
    name: &str,
    settings: &[String],
    law: &LawConfig,
) -> Result<Experiment, CommandError> {
    let experiment = Experiment::load(name, settings)?;
    let setting = match law {
        // JSON's text is TOML's, too.
        LawConfig::Policy(policy) => {
            let file = serde_json::to_string(&policy.file)?;
            format!("control.law={{ policy = {{ file = {file} }} }}")
        }
        law if experiment.config.control.law.name() == law.name() => return Ok(experiment),
        law => format!("control.law={}", law.name()),
    };
    Ok(Experiment::load(name, &[settings, &[setting]].concat())?)
}

/// Opens the folder of each law's sweep in `folder`: a new one, or with --resume as it was left.
pub fn contenders(
    arguments: &TrialArguments,
    folder: &Path,
    laws: Vec<(String, LawConfig, Trials)>,
) -> Result<Vec<Contender>, CommandError> {
    let open = |(name, law, trials)| {
        let store = store(arguments, &folder.join(&name), &trials)?;
        Ok(Contender {
            name,
            law,
            trials,
            store,
        })
    };
    laws.into_iter().map(open).collect()
}

/// The folder of one law's sweep.
fn store(
    arguments: &TrialArguments,
    folder: &Path,
    trials: &Trials,
) -> Result<Store, CommandError> {
    let plan = trials.plan();
    if !(arguments.resume && folder.join(PLAN).exists()) {
        return Ok(Store::create(folder, plan, trials.header())?);
    }
    if let Some(difference) = Plan::read(folder)?.difference(plan) {
        let folder = folder.display();
        return Err(format!(
            "--resume: {folder}: {difference}; expected the comparison that was stopped"
        )
        .into());
    }
    arguments.store(folder, trials)
}

/// Runs what is left, a block of trials of each law after the other.
pub fn run(
    arguments: &TrialArguments,
    contenders: &mut [Contender],
) -> Result<Ended, CommandError> {
    let jobs = arguments.jobs();
    let stop = watch_for_interrupt()?;
    let planned = contenders.first().map_or(0, |c| c.trials.plan().trials);
    let mut bar = Bar::new(planned * contenders.len() as u64);
    let mut end = 0;
    while end < planned {
        end = (end + BLOCK).min(planned);
        for contender in &mut *contenders {
            bar.law.clone_from(&contender.name);
            let Contender { trials, store, .. } = contender;
            if engine::run(trials, store, end, jobs, &stop, &mut bar)? == Ended::Stopped {
                bar.bar.finish_and_clear();
                return Ok(Ended::Stopped);
            }
        }
    }
    bar.bar.finish_and_clear();
    Ok(Ended::Whole)
}

/// How far the comparison is, on a terminal.
struct Bar {
    bar: ProgressBar,
    law: String,
}

impl Bar {
    fn new(trials: u64) -> Self {
        let bar = ProgressBar::new(trials);
        let style = ProgressStyle::with_template("{bar:32} {pos}/{len} trials, {msg}, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self {
            bar,
            law: String::new(),
        }
    }
}

impl Progress for Bar {
    fn show(&mut self, _finished: u64, _of: u64, _successes: u64) {
        self.bar.set_message(self.law.clone());
        self.bar.inc(1);
    }
}
