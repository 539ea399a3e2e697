//! The `feeler hand` subcommand.

use super::{ExperimentArguments, LinkArguments, ListenArguments, first_given};
use crate::experiments::run::make_folder;
use crate::options::FlushArguments;
use crate::{CommandError, Outcome};
use feeler_console::{Warnings, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::run_end;
use feeler_lab::experiment::rigs::linked::{LinkedError, hand_program};
use feeler_lab::experiment::run_facts;
use feeler_link::programs::{HandProgram, RemoteLoop, RigSpeed};
use feeler_link::security::Right;
use feeler_link::transport::Network;
use feeler_record::{RunEnd, RunFacts, RunState};
use feeler_rig::{HandRecord, ListenOptions, open_stop_server, patience, request_real_time};
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment (see `feeler list`).
    experiment: String,
    /// Output folder of the run; must not contain a run [default: runs/NAME-SENSING-seedN]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Request real-time priority and locked memory, so that control steps begin on time.
    #[arg(long)]
    real_time: bool,
    /// Speed relative to real time, the same as the rig's; `max` runs in lockstep with a rig that waits for the hand.
    #[arg(long, default_value = "1")]
    pub speed: RigSpeed,
    #[command(flatten)]
    flush: FlushArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    listening: ListenArguments,
    #[command(flatten)]
    link: LinkArguments,
}

impl Arguments {
    /// Loads the experiment.
    pub fn experiment(&self) -> Result<Experiment, CommandError> {
        let settings = self.values.changes.settings();
        Ok(Experiment::load(&self.experiment, &settings)?)
    }

    /// Returns the first given option that only has an effect if the rig runs in other programs, if any.
    pub fn linking_option(&self) -> Option<&'static str> {
        let own = [
            ("--rig", self.values.rig.is_some()),
            ("--real-time", self.real_time),
            ("--listen", !self.listening.listen.is_empty()),
            ("--insecure", self.listening.insecure),
        ];
        self.link.given().or_else(|| first_given(&own))
    }
}

/// Controls a hand whose sensors and drives run in other programs, until the task is done.
pub fn hand(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let interrupted = watch_for_interrupt()?;
    let create = |experiment: &Experiment, speed, network| {
        let facts = run_facts(&experiment.config)?;
        Ok((hand_program(experiment, speed, network)?, facts))
    };
    run_hand(arguments, &interrupted, out, create, |_| {})
}

/// A hand program and the facts of its run.
pub type ProgramAndFacts = (HandProgram, RunFacts);

/// Runs the hand program that `create` creates with the facts of its run, until its task is done or `interrupted` is set.
/// `each_step` is called after every recorded step.
pub fn run_hand(
    arguments: &Arguments,
    interrupted: &AtomicBool,
    out: &mut dyn Write,
    create: impl FnOnce(&Experiment, RigSpeed, Arc<dyn Network>) -> Result<ProgramAndFacts, LinkedError>,
    mut each_step: impl FnMut(&RemoteLoop),
) -> Result<Outcome, CommandError> {
    let session = arguments
        .values
        .session(&arguments.experiment, &arguments.link)?;
    let (experiment, rig) = (&session.experiment, &session.name);
    let link = session.link.with_right(&[Right::Hand])?;
    let listening = ListenOptions::from(&arguments.listening);
    let network = link.listen(rig, &listening)?;
    let (mut program, facts) = create(experiment, arguments.speed, network)?;
    let warnings = Warnings::on_stderr();
    program.set_warn(warnings.warn());
    let stopper = program.stopper();
    let _door = open_stop_server(&link, &listening, rig, stopper, &warnings);
    let missing = match program.missing() {
        none if none.is_empty() => "fresh data".to_string(),
        missing => missing.join(", "),
    };
    writeln!(out, "waiting for {missing}")?;
    out.flush()?;
    if !program.wait_for_others(interrupted)? {
        return Ok(Outcome::GivenUp);
    }
    if arguments.real_time {
        request_real_time();
    }
    let folder = make_folder(arguments.out.as_deref(), experiment, None)?;
    let mut record = HandRecord::create(
        folder,
        experiment,
        &facts,
        patience(arguments.speed),
        arguments.flush.flush_interval,
        warnings,
    )?;

    let start = Instant::now();
    let ended = program.run(interrupted, |control_loop, instruments| {
        each_step(control_loop);
        record.write(control_loop, instruments)
    });
    let wall_time = start.elapsed().as_secs_f64();
    // Save and report the recording before any error is printed.
    let was_interrupted = interrupted.load(Ordering::Relaxed);
    let end = match &ended {
        Ok(Some(reason)) => RunEnd::because(RunState::GivenUp, reason.as_str()),
        Ok(None) => run_end(None, program.controller(), was_interrupted),
        Err(error) => RunEnd::because(RunState::Interrupted, error.to_string()),
    };
    let finished = record.finish(wall_time, end);
    ended?;
    writeln!(out, "{}", program.report())?;
    finished.print(out)
}
