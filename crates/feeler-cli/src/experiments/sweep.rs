//! The `feeler sweep` subcommand.

use super::trials::TrialArguments;
use crate::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::sweep::results::{Store, TRIALS, read_finished, summary};
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Plan, Shard, SweepError, Table};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

const EXAMPLES: &str = "\
NAME is a key, of which all segments but the last may be omitted while it is unambiguous: cap.radius, slip_threshold.
`friction` is the static friction of all feelers and objects; kinetic friction scales with it. DISTRIBUTION is
uniform(a,b), normal(mean,sd), log_uniform(a,b), choice(a,b,...), a constant, relative(a,b) (times the experiment's
value) or shifted(a,b) (added to it).

Examples:
  feeler sweep cap-closing --sensing direct --trials 10000 --vary 'friction=uniform(0.3,1.2)' -o sweep
  feeler sweep --resume -o sweep                continue an interrupted sweep
  feeler run --trial sweep 4711                 rerun one trial, with recording and report
  feeler sweep cap-closing --trials 10000 --vary 'cap.radius=normal(0.014,0.0002)' --shard 1/2 -o one
  feeler sweep merge one two -o both            merge the results of two machines";

/// Error message for the engine Ray, which is available only from Python.
const NO_RAY: &str = "--engine ray: expected threads; to use several machines, run the sweep from Python, as in \
     feeler.sweep(\"cap-closing\", engine=\"ray\") (see \"On many machines\" in docs/sweeps.md)";

#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = EXAMPLES)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Sub>,
    /// Experiment file or name of a built-in experiment; optional with --resume.
    #[arg(required_unless_present = "resume")]
    experiment: Option<String>,
    /// Number of trials.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    trials: u64,
    /// Parameter and its distribution, e.g. friction=uniform(0.3,1.2). Repeatable.
    #[arg(long = "vary", value_name = "NAME=DISTRIBUTION")]
    vary: Vec<String>,
    /// Source of forces: `image` (rendered camera images) or `direct` (simulated forces plus noise).
    #[arg(long, value_parser = ["image", "direct"])]
    sensing: Option<String>,
    #[command(flatten)]
    trial: TrialArguments,
    /// Engine that runs the trials: threads on this computer, or Ray on several, which is started from Python.
    #[arg(long, value_enum, default_value_t)]
    engine: Engine,
    /// Run only the i-th of n shards.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Output folder.
    #[arg(short, long, value_name = "DIR", default_value = "sweep")]
    out: PathBuf,
}

/// Engine that runs trials.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
enum Engine {
    #[default]
    Threads,
    Ray,
}

#[derive(Debug, clap::Subcommand)]
enum Sub {
    /// Merge the shards of a sweep.
    Merge(MergeArguments),
}

#[derive(Debug, clap::Args)]
struct MergeArguments {
    /// Folders of the shards.
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Output folder; must not contain a sweep.
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
}

pub fn sweep(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if let Some(Sub::Merge(merging)) = &arguments.command {
        return merge(merging, out);
    }
    if arguments.engine == Engine::Ray {
        return Err(NO_RAY.into());
    }
    let plan = plan(arguments)?;
    let trials = Trials::new(&plan)?;
    let folder = &arguments.out;
    let mut store = arguments.trial.store(folder, &trials)?;
    let before = store.table.rows.len();
    let start = Instant::now();
    let ended = arguments.trial.run(&trials, &mut store)?;
    let ran = store.table.rows.len() - before;
    let seconds = start.elapsed().as_secs_f64();
    writeln!(
        out,
        "{ran} trials in {seconds:.1} s, {:.1} trials/s",
        ran as f64 / seconds.max(1e-9)
    )?;
    if ended == Ended::Stopped {
        let finished = store.table.rows.len();
        let folder = folder.display();
        writeln!(
            out,
            "interrupted: {finished} trials are finished and saved; continue with `feeler sweep --resume -o {folder}`"
        )?;
        return Ok(Outcome::GivenUp);
    }
    conclude(folder, &trials, &store.finish()?, out)
}

/// Returns the plan: from the command line, or with `--resume` from the folder.
fn plan(arguments: &Arguments) -> Result<Plan, CommandError> {
    let Some(name) = &arguments.experiment else {
        let others = !(arguments.vary.is_empty() && arguments.trial.settings.is_empty());
        if others || arguments.sensing.is_some() || arguments.shard.is_some() {
            return Err(
                "--resume without an experiment accepts no other options; name the experiment to check \
                        them against the stored plan"
                    .into(),
            );
        }
        return Ok(Plan::read(&arguments.out)?);
    };
    let mut settings = arguments.trial.settings.clone();
    settings.extend(arguments.sensing.iter().map(|s| format!("sensing={s}")));
    let experiment = Experiment::load(name, &settings)?;
    let (seed, trials) = (arguments.trial.seed, arguments.trials);
    let mut plan = Plan::new(&experiment, name, &arguments.vary, seed, trials)?;
    plan.shard = arguments.shard.unwrap_or(Shard::WHOLE);
    match arguments.trial.resume {
        true => Ok(plan.resume(&arguments.out)?),
        false => Ok(plan),
    }
}

fn merge(arguments: &MergeArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let mut plans = Vec::new();
    for folder in &arguments.folders {
        plans.push((folder, Plan::read(folder)?));
    }
    let Some((_, first)) = plans.first().cloned() else {
        return Err("merge: expected at least one folder".into());
    };
    let whole = Plan {
        shard: Shard::WHOLE,
        ..first.clone()
    };
    let trials = Trials::new(&whole)?;
    let mut table = Table::new(trials.header());
    for (folder, plan) in &plans {
        if let Some(difference) = plan.difference(&first) {
            let (folder, other) = (folder.display(), arguments.folders[0].display());
            return Err(
                format!("{folder} is not a shard of the sweep in {other}: {difference}").into(),
            );
        }
        read_finished(folder, plan, &mut table)?;
    }
    let missing: Vec<u64> = (0..whole.trials)
        .filter(|k| !table.rows.contains_key(k))
        .collect();
    if let Some(first) = missing.first() {
        let shard = (plans[0].1.shard.of > 1).then(|| {
            let of = plans[0].1.shard.of;
            format!(", of shard {}/{of}", first % of + 1)
        });
        return Err(format!(
            "{} of {} trials are missing, the first is {first}{}; nothing was written",
            missing.len(),
            whole.trials,
            shard.unwrap_or_default()
        )
        .into());
    }
    let mut store = Store::create(&arguments.out, &whole, trials.header())?;
    store.table = table;
    conclude(&arguments.out, &trials, &store.finish()?, out)
}

/// Writes the summary page and prints the result.
fn conclude(
    folder: &Path,
    trials: &Trials,
    table: &Table,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    summary::write(folder, trials, table)?;
    let (count, successes) = table.successes();
    let meaning = trials.success();
    let share = 100.0 * successes as f64 / count.max(1) as f64;
    writeln!(
        out,
        "{successes} of {count} trials succeeded ({share:.1} %: {meaning})"
    )?;
    writeln!(out, "{}", folder.join(TRIALS).display())?;
    writeln!(
        out,
        "{}",
        folder
            .join(feeler_lab::sweep::results::SUMMARY_PAGE)
            .display()
    )?;
    Ok(Outcome::Done)
}

/// Returns the experiment of one trial of the sweep in `folder`.
pub fn one_trial(folder: &Path, trial: &str) -> Result<Experiment, CommandError> {
    let plan = Plan::read(folder)?;
    let count = plan.trials;
    let number = trial.parse().ok().filter(|&number: &u64| number < count);
    let number = number.ok_or_else(|| {
        let folder = folder.display();
        format!(
            "--trial {folder} {trial}: expected a trial from 0 to {}",
            count - 1
        )
    })?;
    let trials = Trials::new(&plan).map_err(|e: SweepError| e.to_string())?;
    Ok(trials.experiment(number)?)
}
