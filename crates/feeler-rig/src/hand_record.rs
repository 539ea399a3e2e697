//! The record of a hand that moves, which never waits for it.

use crate::run_outcome::{make_report, print_outcome};
use feeler::control::controller::RecordingFailure;
use feeler_console::Warnings;
use feeler_console::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::run_facts;
use feeler_link::programs::{RemoteLoop, RigSpeed};
use feeler_record::{
    CLOSE_LIMIT, InstrumentRecord, Patience, RecordError, RecordOptions, Recorder, RunEnd, RunLog,
};
use feeler_report::make::{RECORDING, ReportOutcome};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Duration;

/// How long a step may wait for the disk where the rig waits for the hand: it takes the hand for lost after 5 s.
const LOCKSTEP_PATIENCE: Duration = Duration::from_secs(1);

/// How long a hand may wait for its record, whose rig's time goes at `speed`: not at all unless that waits for the hand.
pub fn patience(speed: RigSpeed) -> Patience {
    Patience::Limited(match speed {
        RigSpeed::Lockstep => LOCKSTEP_PATIENCE,
        RigSpeed::Times(_) => Duration::ZERO,
    })
}

/// The record of a hand that moves.
pub struct HandRecord {
    log: RunLog,
    folder: PathBuf,
    on_failure: RecordingFailure,
    warnings: Warnings,
    /// What was said last of the file.
    state: State,
}

/// How the file does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Written,
    /// It takes nothing; messages dropped until then.
    Full(u64),
    Failed,
}

impl HandRecord {
    /// Begins in `folder` the record of a hand of `experiment`, which is handed on once in a flush interval (s).
    ///
    /// # Errors
    /// When a fingertip makes no sense or the file cannot be written.
    pub fn create(
        (folder, experiment): (PathBuf, &Experiment),
        (patience, flush_interval): (Patience, f64),
        warnings: Warnings,
    ) -> Result<Self, CommandError> {
        let config = &experiment.config;
        let options = RecordOptions {
            patience,
            flush_interval,
            policy: experiment.policy_file()?,
            ..RecordOptions::default()
        };
        let facts = run_facts(config)?;
        let file = folder.join(RECORDING);
        let recorder = Recorder::create_with(file, &facts, &experiment.toml, &options)?;
        Ok(Self {
            log: RunLog::new(recorder, &facts)?,
            folder,
            on_failure: config.control.on_recording_failure,
            warnings,
            state: State::Written,
        })
    }

    /// Writes the newest step; breaks with the reason where the hand is to stop for want of a record.
    pub fn write(
        &mut self,
        control_loop: &RemoteLoop,
        instruments: InstrumentRecord<'_>,
    ) -> ControlFlow<String> {
        let written = self.log.write(control_loop, instruments);
        let recorder = self.log.recorder_mut();
        let dropped = recorder.dropped();
        let failure = written.err().map(|error| error.to_string());
        let failure = failure.or_else(|| recorder.failure().map(ToString::to_string));
        match (self.state, failure, recorder.gap()) {
            (State::Failed, ..) => {}
            (_, Some(failure), _) => {
                self.state = State::Failed;
                return self.trouble(&failure, "goes on without a record");
            }
            (State::Written, None, Some(gap)) => {
                let before = dropped - gap.messages;
                let what = format!("recording: the disk takes nothing at {:.2} s", gap.end);
                self.state = State::Full(before);
                return self.trouble(&what, "goes on, and messages are dropped");
            }
            (State::Full(before), None, None) => {
                let count = dropped - before;
                self.state = State::Written;
                let what = format!("recording: goes on; {count} messages are missing");
                self.warnings.queue(&what);
            }
            _ => {}
        }
        ControlFlow::Continue(())
    }

    /// Says `what` goes wrong, and stops the hand if it is to.
    fn trouble(&self, what: &str, goes_on: &str) -> ControlFlow<String> {
        match self.on_failure {
            RecordingFailure::Continue => {
                self.warnings.queue(&format!("{what}; the hand {goes_on}"));
                ControlFlow::Continue(())
            }
            RecordingFailure::Stop => {
                let why = "as control.on_recording_failure = \"stop\" says";
                let reason = format!("the hand was stopped: {what}, {why}");
                self.warnings.queue(&reason);
                ControlFlow::Break(reason)
            }
        }
    }

    /// Closes the recording of a run that took `wall_time` (s) and ended so, and makes its report, as far as the disk
    /// allows.
    pub fn finish(self, wall_time: f64, end: RunEnd) -> FinishedRecord {
        let Self {
            log,
            folder,
            warnings,
            ..
        } = self;
        let mut recorder = log.into_recorder();
        recorder.set_end(end.clone());
        let slow = || {
            let left = CLOSE_LIMIT.as_secs() - 1;
            warnings.queue(&format!(
                "recording: the disk takes nothing; waiting {left} s more"
            ));
        };
        let closed = recorder.finish_within(Some(wall_time), CLOSE_LIMIT, slow);
        let report = match &closed {
            // A report would wait for the same disk.
            Err(RecordError::NotClosed { .. }) => None,
            _ => Some(make_report(&folder).map_err(CommandError::from)),
        };
        FinishedRecord {
            end,
            failure: closed.err(),
            report,
        }
    }
}

/// What came of a record.
pub struct FinishedRecord {
    end: RunEnd,
    /// Why it is partial, if it could not be closed.
    failure: Option<RecordError>,
    report: Option<Result<ReportOutcome, CommandError>>,
}

impl FinishedRecord {
    /// Prints how the run ended and whether its record is whole; what the program ends with.
    ///
    /// # Errors
    /// When the report cannot be made of a recording that is whole, or nothing can be printed.
    pub fn print(self, out: &mut dyn Write) -> Result<Outcome, CommandError> {
        if let Some(failure) = self.failure {
            write!(out, "{}", self.end.state)?;
            if let Some(reason) = &self.end.reason {
                write!(out, ": {reason}")?;
            }
            writeln!(out, "\nthe recording is partial: {failure}")?;
            match self.report {
                Some(Ok(made)) => writeln!(out, "{}", made.report_path.display())?,
                Some(Err(error)) => writeln!(out, "no report: {error}")?,
                None => {}
            }
            return Ok(Outcome::GivenUp);
        }
        let Some(made) = self.report.transpose()? else {
            return Ok(Outcome::GivenUp);
        };
        print_outcome(&made, out)?;
        if let Some(problem) = &made.problem {
            writeln!(out, "the recording is partial: {problem}")?;
            return Ok(Outcome::GivenUp);
        }
        Ok(Outcome::from(&self.end))
    }
}
