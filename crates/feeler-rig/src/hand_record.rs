//! Recording of a moving hand, which never blocks the hand.

use crate::run_outcome::{make_report, print_outcome};
use feeler::control::RecordingFailure;
use feeler_console::{CommandError, Outcome, Warnings};
use feeler_lab::config::Experiment;
use feeler_link::programs::{RemoteLoop, RigSpeed};
use feeler_record::{
    Backpressure, CLOSE_TIMEOUT, InstrumentRecord, RecordError, RecordOptions, Recorder, RunEnd,
    RunFacts, RunLog,
};
use feeler_report::run::make::{RECORDING, ReportOutcome};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Duration;

/// Maximum time that a step waits for the disk in lockstep. The rig considers the hand lost after 5 s.
const LOCKSTEP_PATIENCE: Duration = Duration::from_secs(1);

/// Returns the maximum time that a step waits for its recording: zero except in lockstep.
pub fn patience(speed: RigSpeed) -> Backpressure {
    Backpressure::Limited(match speed {
        RigSpeed::Lockstep => LOCKSTEP_PATIENCE,
        RigSpeed::Times(_) => Duration::ZERO,
    })
}

/// Recording of a moving hand.
pub struct HandRecord {
    log: RunLog,
    folder: PathBuf,
    on_failure: RecordingFailure,
    warnings: Warnings,
    /// Last reported state of the file.
    state: State,
}

/// State of the recording file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Written,
    /// The disk accepts no data; contains the number of messages that had been dropped before.
    Full(u64),
    Failed,
}

impl HandRecord {
    /// Starts the recording of a hand of `experiment` with these `facts` in `folder`, flushed once per `flush_interval` (s).
    ///
    /// # Errors
    /// If the policy of the experiment cannot be read, or the recording cannot be written.
    pub fn create(
        folder: PathBuf,
        experiment: &Experiment,
        facts: &RunFacts,
        patience: Backpressure,
        flush_interval: f64,
        warnings: Warnings,
    ) -> Result<Self, CommandError> {
        let config = &experiment.config;
        let options = RecordOptions {
            patience,
            flush_interval,
            samples: true,
            policy: experiment.policy_file()?,
            efforts: config.measures_efforts(),
            ..RecordOptions::default()
        };
        let file = folder.join(RECORDING);
        let recorder = Recorder::create_with(file, facts, &experiment.toml, &options)?;
        let log = RunLog::new(recorder, facts)?;
        Ok(Self {
            log: match options.efforts {
                true => log.with_efforts(),
                false => log,
            },
            folder,
            on_failure: config.control.on_recording_failure,
            warnings,
            state: State::Written,
        })
    }

    /// Writes the latest step. Breaks with the reason if the hand must stop because of a recording failure.
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
                return self.trouble(&failure, "continues without recording");
            }
            (State::Written, None, Some(gap)) => {
                let before = dropped - gap.messages;
                let what = format!("recording: the disk accepts no data at {:.2} s", gap.end);
                self.state = State::Full(before);
                return self.trouble(&what, "continues, and messages are dropped");
            }
            (State::Full(before), None, None) => {
                let count = dropped - before;
                self.state = State::Written;
                let what = format!("recording: resumed; {count} messages are missing");
                self.warnings.queue(&what);
            }
            _ => {}
        }
        ControlFlow::Continue(())
    }

    /// Reports a failure, and stops the hand if configured.
    fn trouble(&self, what: &str, goes_on: &str) -> ControlFlow<String> {
        match self.on_failure {
            RecordingFailure::Continue => {
                self.warnings.queue(&format!("{what}; the hand {goes_on}"));
                ControlFlow::Continue(())
            }
            RecordingFailure::Stop => {
                let why = "as configured by control.on_recording_failure = \"stop\"";
                let reason = format!("the hand was stopped: {what}, {why}");
                self.warnings.queue(&reason);
                ControlFlow::Break(reason)
            }
        }
    }

    /// Closes the recording of a run with the given duration (s) and result, and creates its report unless the disk
    /// accepts no data.
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
            let left = CLOSE_TIMEOUT.as_secs() - 1;
            warnings.queue(&format!(
                "recording: the disk accepts no data; waiting up to {left} s more"
            ));
        };
        let closed = recorder.finish_within(Some(wall_time), CLOSE_TIMEOUT, slow);
        let report = match &closed {
            // A report would block on the same disk.
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

/// Result of a recording.
pub struct FinishedRecord {
    end: RunEnd,
    /// Error that left the recording partial, if any.
    failure: Option<RecordError>,
    report: Option<Result<ReportOutcome, CommandError>>,
}

impl FinishedRecord {
    /// Prints the result of the run and whether its recording is complete; returns the program's outcome.
    ///
    /// # Errors
    /// If the report of a complete recording cannot be created, or printing fails.
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
