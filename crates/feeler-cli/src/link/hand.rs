//! `feeler hand`

use super::{ExperimentArguments, LinkArguments, ListenArguments, warn_on_stderr};
use crate::interrupt::watch_for_interrupt;
use crate::report::print_outcome;
use crate::run::make_folder;
use crate::{CommandError, Outcome};
use feeler::pace::real_time::{self, MODERATE, Refusal};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::linked::hand_program;
use feeler_lab::experiment::recorded_run::{finish, run_end};
use feeler_lab::experiment::{layouts, run_facts};
use feeler_link::programs::{HandProgram, RigSpeed};
use feeler_link::right::Right;
use feeler_record::{RecordOptions, Recorder, RunLog};
use feeler_report::make::RECORDING;
use std::io::{Write, stderr};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment to run: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// The run's folder, which must not hold a run yet [default: runs/NAME-SENSING-seedN]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Ask the system for real-time priority and for memory that is never swapped out, so that control
    /// steps begin on time.
    #[arg(long)]
    real_time: bool,
    /// Seconds of the experiment in a second, the same as the rig's; `max` where that waits for the hand.
    #[arg(long, default_value = "1")]
    speed: RigSpeed,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    listening: ListenArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Controls a hand whose fingers and drives are in other programs, until the task is done.
pub fn hand(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.values.settings())?;
    let rig = arguments.values.rig(&experiment);
    let network = arguments
        .link
        .with_right(&[Right::Hand])?
        .listen(&rig, &arguments.listening)?;
    let interrupted = watch_for_interrupt()?;
    let mut program = hand_program(&experiment, arguments.speed, network)?;
    program.set_warn(warn_on_stderr());
    writeln!(out, "waiting for {}", program.missing().join(", "))?;
    out.flush()?;
    if !program.wait_for_others(&interrupted)? {
        return Ok(Outcome::GivenUp);
    }
    if arguments.real_time {
        ask_for_real_time();
    }
    let folder = make_folder(arguments.out.as_deref(), &experiment, None)?;
    let facts = run_facts(&experiment.config);
    let options = RecordOptions::default();
    let recorder =
        Recorder::create_with(folder.join(RECORDING), &facts, &experiment.toml, &options)?;
    let mut log = RunLog::new(recorder, &layouts(&experiment.config)?);

    let start = Instant::now();
    let ended = run(&mut program, &mut log, &interrupted);
    let wall_time = start.elapsed().as_secs_f64();
    // However it ended: what was recorded is kept and reported before anything is said.
    let was_interrupted = interrupted.load(Ordering::Relaxed);
    let failed = ended.as_ref().err().map(ToString::to_string);
    let end = run_end(failed, program.controller(), was_interrupted);
    let outcome = Outcome::from(&end);
    let made = finish(log, wall_time, end, &folder);
    ended?;
    writeln!(out, "{}", program.report())?;
    print_outcome(&made?, out)?;
    Ok(outcome)
}

fn run(
    program: &mut HandProgram,
    log: &mut RunLog,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let failed = program.run(interrupted, |control_loop, instruments| {
        match log.write(control_loop, instruments) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => ControlFlow::Break(error),
        }
    })?;
    failed.map_or(Ok(()), |error| Err(error.into()))
}

/// Asks for what keeps steps on time, and says what is refused: the hand goes on without.
fn ask_for_real_time() {
    let asked: [(&str, Result<(), Refusal>); 2] = [
        ("real-time priority", real_time::raise_priority(MODERATE)),
        ("locked memory", real_time::lock_memory()),
    ];
    for (what, answer) in asked {
        if let Err(refusal) = answer {
            // Where nobody listens, the punctuality at the end says it.
            let _ = writeln!(stderr(), "warning: no {what}: {refusal}");
        }
    }
}
