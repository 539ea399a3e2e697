//! `feeler replay`

use super::{CommandError, Outcome};
use feeler_console::watch_for_interrupt;
use feeler_console::{Steps, Working};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::replay::{Comparison, Kind, Replay, ReplayFrom, recorded_experiment};
use feeler_lab::experiment::run_facts;
use feeler_lab::experiment::run_folder;
use feeler_record::{RecordOptions, Recorder, Recording, RunFacts};
use feeler_report::make::RECORDING;
use feeler_rig::{make_report, print_outcome};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

const DETAILS: &str = "\
From frames: pictures -> forces -> flags -> commands. From forces: forces -> flags -> commands. Joint angles are those on record, whatever the commands. Experiment and calibration are the recording's own. Stops that came from outside the control law are repeated where they are on record.

Exit status: 0 all is as on record, or settings were changed with --set; 1 something differs; 2 bad input, or a recording that is not whole.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// The run's folder, or a recording.
    run: PathBuf,
    /// Begin at the cameras' pictures (of a run made with --record-frames) or at the forces.
    #[arg(long)]
    from: From,
    /// Replay with another value, as in control.slip_threshold=2.5; what differs then is counted.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Write the replay's own recording and report into this folder, which must not hold a run yet.
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
    // Refused before a folder is made for it.
    let replay = Replay::new(&recording, from, &experiment)?;
    let replay = match &arguments.out {
        Some(folder) => replay.copy_to(copy(folder, &recording, &experiment, from)?)?,
        None => replay,
    };
    let interrupted = watch_for_interrupt()?;
    let steps = replay.steps();
    let (comparison, copy, ended) = go_through(replay, &interrupted);
    // However it ended: what was compared is said, and the copy is closed and reported.
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
        let until = match recording.task.get(recording.steps_in_a_row()) {
            Some(next) => format!(
                "{:.2} s, as no replay is bit for bit over a gap",
                next.stamp
            ),
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

/// A recording of the replay, in a folder of its own.
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

/// Goes to the end of the record, or to Ctrl-C: how it compares until there, the copy, and what went wrong.
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

/// Prints what was compared, how much of it differs, and the first difference of each kind.
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
        "{experiment}, seed {seed}: {steps} steps of {fingers} fingers on record"
    )?;
    writeln!(out, "{:9} {:>9} {:>9}", "", "compared", "differing")?;
    let tallies = Kind::ALL.map(|kind| (kind, comparison.of(kind)));
    for (kind, tally) in tallies.iter().filter(|(_, tally)| tally.compared > 0) {
        let (compared, differing) = (tally.compared, tally.differing);
        writeln!(out, "{kind:9} {compared:>9} {differing:>9}")?;
    }
    for (kind, tally) in tallies {
        if let Some(first) = &tally.first {
            writeln!(out, "first of {kind}: {first}")?;
        }
    }
    let whole = comparison.of(Kind::Phases).compared == steps as u64;
    if comparison.same() && whole {
        writeln!(out, "the same as on record, bit for bit")?;
    }
    let this = env!("CARGO_PKG_VERSION");
    if !comparison.same() && version != this {
        writeln!(out, "recorded by feeler {version}, replayed by {this}")?;
    }
    Ok(())
}
