//! `feeler hand`

pub mod program;

use super::{ExperimentArguments, LinkArguments};
use crate::interrupt::watch_for_interrupt;
use crate::report::print_outcome;
use crate::run::{finish, make_folder, run_end};
use crate::{CommandError, Outcome};
use feeler::pace::real_time::{self, MODERATE, Refusal};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::layouts;
use feeler_lab::experiment::log::{RunLog, run_facts};
use feeler_record::{RecordOptions, Recorder};
use feeler_report::make::RECORDING;
use program::Program;
use std::io::{Write, stderr};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
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
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Controls a hand whose fingers and drives are in other programs, until the task is done.
pub fn hand(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.values.settings())?;
    let rig = arguments.values.rig(&experiment);
    let network = arguments.link.open(&rig, true)?;
    let interrupted = watch_for_interrupt()?;
    let mut program = Program::new(&experiment, network)?;
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
    let ended = program.run(&mut log, &interrupted);
    let wall_time = start.elapsed().as_secs_f64();
    program.stand_still();
    // However it ended: what was recorded is kept and reported before anything is said.
    let was_interrupted = interrupted.load(Ordering::Relaxed);
    let end = run_end(&ended, program.controller(), was_interrupted);
    let outcome = Outcome::from(&end);
    let made = finish(log, wall_time, end, &folder);
    ended?;
    program.tell(out)?;
    print_outcome(&made?, out)?;
    Ok(outcome)
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
