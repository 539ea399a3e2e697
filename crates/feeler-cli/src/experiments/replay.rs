//! The `feeler replay` subcommand.

use crate::{CommandError, Outcome};
use feeler_console::{Steps, Working, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::replay::{Comparison, Kind, Replay, ReplayFrom, recorded_experiment};
use feeler_lab::experiment::{run_facts, run_folder};
use feeler_record::{RecordOptions, Recorder, Recording, RunFacts};
use feeler_report::run::RECORDING;
use feeler_rig::{make_report, print_outcome};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

const DETAILS: &str = "\
From frames: images -> forces -> flags -> commands. From forces: forces -> flags -> commands. Joint angles, experiment and calibration are taken from the recording; replayed commands do not move the joints. Stops from outside the control law are repeated as recorded.

Exit status: 0 identical, or settings were changed with --set; 1 different; 2 invalid input or incomplete recording.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Folder of the run, or a recording.
    run: PathBuf,
    /// Stage at which to begin: camera images (requires a run with --record-frames) or forces.
    #[arg(long)]
    from: From,
    /// Override an experiment value, e.g. control.slip_threshold=2.5; differences are counted. Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Write a recording and report of the replay to this folder, which must not contain a run.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum From {
    Frames,
    Forces,
}

pub fn replay(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let path = run_folder::recording(&arguments.run)?;
    let reading = Working::on("reading the recording");
    let recording = Recording::read(&path)?;
    drop(reading);
    let experiment = recorded_experiment(&recording, &arguments.settings)?;
    let from = match arguments.from {
        From::Frames => ReplayFrom::Frames(&path),
        From::Forces => ReplayFrom::Forces,
    };
    // Fail before creating a folder.
    let replay = Replay::new(&recording, from, &experiment)?;
    let replay = match &arguments.out {
        Some(folder) => replay.copy_to(copy(folder, &recording, &experiment, from)?)?,
        None => replay,
    };
    let interrupted = watch_for_interrupt()?;
    let steps = replay.steps();
    let (comparison, copy, ended) = go_through(replay, &interrupted);
    // In any case, print the comparison, close the copy and report on it.
    let closed = copy.map_or(Ok(()), |copy| copy.finish(None).map(|_| ()));
    print_comparison(&recording.facts, &comparison, steps, out)?;
    let made = arguments.out.as_deref().map(make_report).transpose();
    ended?;
    closed?;
    if let Some(made) = made? {
        print_outcome(&made, out)?;
    }
    if let Some(problem) = &recording.problem {
        let path = path.display();
        let until = match recording.task.get(recording.leading_complete_steps()) {
            Some(next) => format!("{:.2} s, because a gap follows", next.stamp),
            None => format!("{:.2} s", recording.readable_until),
        };
        return Err(format!(
            "{path}: the recording is incomplete ({problem}); replayed up to {until}"
        )
        .into());
    }
    if interrupted.load(Ordering::Relaxed) {
        writeln!(out, "interrupted: the rest was not compared")?;
        return Ok(Outcome::GivenUp);
    }
    Ok(if comparison.same() || !arguments.settings.is_empty() {
        Outcome::Done
    } else {
        Outcome::Differs
    })
}

/// Creates a recording of the replay in `folder`.
fn copy(
    folder: &Path,
    recording: &Recording,
    experiment: &Experiment,
    from: ReplayFrom<'_>,
) -> Result<Recorder, CommandError> {
    run_folder::named(folder).map_err(|e| format!("--out {e}"))?;
    let facts = RunFacts {
        replay_of: Some(recording.digest.to_string()),
        truth: recording.facts.truth.clone(),
        ..run_facts(&experiment.config)?
    };
    let options = RecordOptions {
        calibrations: match from {
            ReplayFrom::Frames(_) => experiment.calibration_texts()?,
            ReplayFrom::Forces => recording.calibrations.clone(),
        },
        policy: experiment.policy_file()?,
        efforts: recording.has_efforts(),
        ..RecordOptions::default()
    };
    let file = folder.join(RECORDING);
    Ok(Recorder::create_with(
        file,
        &facts,
        &experiment.toml,
        &options,
    )?)
}

/// Replays until the end of the recording or Ctrl-C; returns the comparison so far, the copy, and the error if any.
fn go_through(
    mut replay: Replay<'_>,
    interrupted: &AtomicBool,
) -> (Comparison, Option<Recorder>, Result<(), CommandError>) {
    let progress = Steps::new(replay.steps());
    let mut ended = Ok(());
    while ended.is_ok() && !replay.finished() && !interrupted.load(Ordering::Relaxed) {
        ended = replay.step();
        progress.advance();
    }
    drop(progress);
    let (comparison, copy) = replay.finish();
    (comparison, copy, ended.map_err(CommandError::from))
}

/// Prints the number of compared and differing values, and the first difference of each kind.
fn print_comparison(
    facts: &RunFacts,
    comparison: &Comparison,
    steps: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    let RunFacts {
        experiment,
        seed,
        fingers,
        version,
        ..
    } = facts;
    writeln!(
        out,
        "{experiment}, seed {seed}: {steps} recorded steps of {fingers} fingers"
    )?;
    writeln!(out, "{:9} {:>9} {:>9}", "", "compared", "differing")?;
    let tallies = Kind::ALL.map(|kind| (kind, comparison.of(kind)));
    for (kind, tally) in tallies.iter().filter(|(_, tally)| tally.compared > 0) {
        let (compared, differing) = (tally.compared, tally.differing);
        writeln!(out, "{kind:9} {compared:>9} {differing:>9}")?;
    }
    for (kind, tally) in tallies {
        if let Some(first) = &tally.first {
            writeln!(out, "first difference of {kind}: {first}")?;
        }
    }
    let whole = comparison.of(Kind::Phases).compared == steps as u64;
    if comparison.same() && whole {
        writeln!(out, "identical to the recording, bit for bit")?;
    }
    let this = env!("CARGO_PKG_VERSION");
    if !comparison.same() && version != this {
        writeln!(out, "recorded by feeler {version}, replayed by {this}")?;
    }
    Ok(())
}
