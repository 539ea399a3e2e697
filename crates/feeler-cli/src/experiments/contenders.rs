//! Control laws on the same trials: one sweep per law, in a folder named after the law.

use super::trials::{TRIALS_BAR, TrialArguments};
use crate::{CommandError, Outcome};
use feeler::control::law::LawConfig;
use feeler_console::{Bar, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::sweep::plan::PLAN;
use feeler_lab::sweep::results::Store;
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Plan, Progress, engine};
use std::io::Write;
use std::path::Path;

/// Number of consecutive trials of one law. Interleaving gives an interrupted comparison equal trials of all laws.
const BLOCK: u64 = 32;

/// A law and its sweep.
pub struct Contender {
    /// Name of the law and of its folder.
    pub name: String,
    /// The law.
    pub law: LawConfig,
    /// The law's trials.
    pub trials: Trials,
    /// Results of the trials.
    pub store: Store,
}

/// Loads the experiment `name` with `settings` and the control law `law`. The law that the experiment selects keeps its
/// configuration; other laws use their defaults.
pub fn under_law(
    name: &str,
    settings: &[String],
    law: &LawConfig,
) -> Result<Experiment, CommandError> {
    let experiment = Experiment::load(name, settings)?;
    let setting = match law {
        // A JSON string is a valid TOML string.
        LawConfig::Policy(policy) => {
            let file = serde_json::to_string(&policy.file)?;
            format!("control.law={{ policy = {{ file = {file} }} }}")
        }
        law if experiment.config.control.law.name() == law.name() => return Ok(experiment),
        law => format!("control.law={}", law.name()),
    };
    Ok(Experiment::load(name, &[settings, &[setting]].concat())?)
}

/// Opens the folder of each law's sweep in `folder`: a new one, or the existing one with --resume.
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

/// Opens the folder of one law's sweep.
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
            "--resume: {folder}: {difference}; expected the interrupted comparison"
        )
        .into());
    }
    arguments.store(folder, trials)
}

/// Runs the remaining trials, alternating between the laws in blocks.
pub fn run(
    arguments: &TrialArguments,
    contenders: &mut [Contender],
) -> Result<Ended, CommandError> {
    let jobs = arguments.jobs();
    let stop = watch_for_interrupt()?;
    let planned = contenders.first().map_or(0, |c| c.trials.plan().trials);
    let mut bar = ComparisonBar {
        bar: Bar::new(planned * contenders.len() as u64, TRIALS_BAR),
        law: String::new(),
    };
    let mut end = 0;
    while end < planned {
        end = (end + BLOCK).min(planned);
        for contender in &mut *contenders {
            bar.law.clone_from(&contender.name);
            let Contender { trials, store, .. } = contender;
            if engine::run(trials, store, end, jobs, &stop, &mut bar)? == Ended::Stopped {
                return Ok(Ended::Stopped);
            }
        }
    }
    Ok(Ended::Whole)
}

/// Completes the results of all laws, or reports on `out` how many trials of each are finished if the run was stopped.
pub fn close(
    contenders: Vec<Contender>,
    ended: Ended,
    finished: u64,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    if ended == Ended::Stopped {
        writeln!(
            out,
            "interrupted: {finished} trials of every law are finished and saved; continue with the same command and --resume"
        )?;
        return Ok(Outcome::GivenUp);
    }
    for contender in contenders {
        contender.store.finish()?;
    }
    Ok(Outcome::Done)
}

/// Progress bar of a comparison.
struct ComparisonBar {
    bar: Bar,
    law: String,
}

impl Progress for ComparisonBar {
    fn show(&mut self, _finished: u64, _of: u64, _successes: u64) {
        self.bar.set_message(self.law.clone());
        self.bar.inc(1);
    }
}
