//! Simulated runs that are recorded in a folder and reported there.

use super::reported_recorder::{Recorded, ReportingRecorder};
use super::{ExperimentError, Instruments, Pictures, Session, SimulatedLoop};
use crate::config::{ConfigError, Experiment, Sensing};
use feeler::control::{Controller, Phase};
use feeler::pace::{Schedule, Tick};
use feeler_record::{Felt, RecordError, RecordOptions, Recorder, RunEnd, RunLog, RunState};
use feeler_report::run::{RECORDING, ReportError, ReportOutcome, make, make_of};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Error of a run, its recording or its report.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The experiment file or a calibration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The run could not be set up, or failed.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// Images were requested, but the sensing model takes none.
    #[error("cannot record images with sensing = \"direct\"; expected sensing = \"image\"")]
    NoPictures,
    /// The recording could not be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The report could not be generated.
    #[error(transparent)]
    Report(#[from] ReportError),
}

/// A run with its recording.
pub struct RecordedRun {
    session: Session,
    log: RunLog<ReportingRecorder>,
    folder: PathBuf,
}

impl RecordedRun {
    /// Sets up a run of `experiment` with a recording in the existing `folder`, including the camera images if
    /// `pictures` is `true`.
    ///
    /// # Errors
    /// If a part of the experiment is invalid, or the recording cannot be written.
    pub fn new(experiment: &Experiment, pictures: bool, folder: &Path) -> Result<Self, RunError> {
        let options = record_options(experiment, pictures)?;
        let session = session(experiment, &options)?;
        Self::of_session(session, experiment, &options, folder)
    }

    /// Creates the recording of a `session` of `experiment` with `options`.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn of_session(
        session: Session,
        experiment: &Experiment,
        options: &RecordOptions,
        folder: &Path,
    ) -> Result<Self, RunError> {
        let facts = session.facts(&experiment.config);
        let file = folder.join(RECORDING);
        let recorder = Recorder::create_with(file, &facts, &experiment.toml, options)?;
        let recorder = ReportingRecorder::new(recorder, &facts, &experiment.toml, options)?;
        let mut log = RunLog::new(recorder, &facts)?;
        if options.pictures {
            log = log.with_pictures();
        }
        if options.efforts {
            log = log.with_efforts();
        }
        Ok(Self {
            log,
            session,
            folder: folder.into(),
        })
    }

    /// Disables the collection of report data during the run, which could delay a schedule in real time. The data are
    /// read from the recording after the run instead.
    #[must_use]
    pub fn keeping_time(mut self) -> Self {
        self.log.recorder_mut().without_columns();
        self
    }

    /// Executes the run as [`Session::run`], closes the recording and generates the report. The recording is kept and
    /// reported however the run ends. `each_step` returns the rumble and tone that the live page has played since the
    /// last step, if any. Returns the session after its last step, the end of the run, and the report.
    ///
    /// # Errors
    /// If the run, the recording or the report fails.
    pub fn run(
        self,
        schedule: &mut impl Schedule,
        interrupted: &AtomicBool,
        each_step: impl FnMut(&mut SimulatedLoop, &Instruments, &Tick) -> Option<Felt>,
    ) -> Result<FinishedRun, RunError> {
        self.record(schedule, interrupted, each_step).report()
    }

    /// Like [`run`](Self::run), without the report. The returned run can generate it from the closed recording.
    pub fn record(
        self,
        schedule: &mut impl Schedule,
        interrupted: &AtomicBool,
        mut each_step: impl FnMut(&mut SimulatedLoop, &Instruments, &Tick) -> Option<Felt>,
    ) -> ClosedRun {
        let Self {
            mut session,
            mut log,
            folder,
        } = self;
        let start = Instant::now();
        let ran = session.run(schedule, interrupted, |control_loop, at, tick| {
            let recorded = at.record(control_loop, &mut log);
            let recorded = recorded.and_then(|()| match each_step(control_loop, at, tick) {
                Some(felt) => log.write_felt(&felt),
                None => Ok(()),
            });
            match recorded {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => ControlFlow::Break(error),
            }
        });
        let wall_time = start.elapsed().as_secs_f64();
        let failed = match ran {
            Ok(None) => None,
            Ok(Some(error)) => Some(RunError::from(error)),
            Err(error) => Some(RunError::from(error)),
        };
        let controller = session.control_loop().controller();
        let reason = failed.as_ref().map(ToString::to_string);
        let end = run_end(reason, controller, interrupted.load(Ordering::Relaxed));
        ClosedRun {
            closed: log.into_recorder().finish(wall_time, end.clone()),
            failed,
            session,
            folder,
            wall_time,
            end,
        }
    }
}

/// A run whose recording is closed.
pub struct ClosedRun {
    session: Session,
    folder: PathBuf,
    wall_time: f64,
    end: RunEnd,
    failed: Option<RunError>,
    /// Content of the recording. `None` if it must be read from the file.
    closed: Result<Option<Recorded>, RecordError>,
}

impl ClosedRun {
    /// Generates the report, even if the run failed.
    ///
    /// # Errors
    /// If the run, the recording or the report failed.
    pub fn report(self) -> Result<FinishedRun, RunError> {
        let report = match self.closed {
            Ok(Some((recording, data))) => {
                make_of(&self.folder, &recording, &data).map_err(RunError::from)
            }
            Ok(None) => make(&self.folder).map_err(RunError::from),
            Err(error) => Err(error.into()),
        };
        if let Some(error) = self.failed {
            return Err(error);
        }
        Ok(FinishedRun {
            report: report?,
            session: self.session,
            wall_time: self.wall_time,
            end: self.end,
        })
    }
}

/// A run that is complete, recorded and reported.
pub struct FinishedRun {
    /// The session after its last step.
    pub session: Session,
    /// Outcome and reason of the end of the run.
    pub end: RunEnd,
    /// Duration of the run in wall-clock time (s).
    pub wall_time: f64,
    /// Files and content of the report.
    pub report: ReportOutcome,
}

/// Returns the options for recording: the policy, if any, the calibrations if forces are computed from images,
/// and the images themselves if `pictures` is `true`.
///
/// # Errors
/// If images are requested but not taken, or a calibration or the policy cannot be read.
pub fn record_options(experiment: &Experiment, pictures: bool) -> Result<RecordOptions, RunError> {
    let options = RecordOptions {
        policy: experiment.policy_file()?,
        ..RecordOptions::default()
    };
    match experiment.config.sensing {
        Sensing::Image => Ok(RecordOptions {
            calibrations: experiment.calibration_texts()?,
            pictures,
            ..options
        }),
        Sensing::Direct if pictures => Err(RunError::NoPictures),
        Sensing::Direct => Ok(options),
    }
}

/// Sets up the session of a run that is recorded with `options`.
///
/// # Errors
/// If a part of the experiment is invalid.
pub fn session(
    experiment: &Experiment,
    options: &RecordOptions,
) -> Result<Session, ExperimentError> {
    // Whole images are needed only for the recording.
    let pictures = match options.pictures {
        true => Pictures::Whole,
        false => Pictures::Sensed,
    };
    let session = Session::rendering(experiment, pictures)?;
    match experiment.config.sensing {
        Sensing::Image => session.sensing_side_by_side(),
        // Direct sensing is faster than the transfer to a thread.
        Sensing::Direct => Ok(session),
    }
}

/// Returns the end of a run of `controller` from the error `failed`, the state of the hand or the task, or the flag
/// `interrupted`, in this order.
pub fn run_end(failed: Option<String>, controller: &Controller, interrupted: bool) -> RunEnd {
    let given_up = |reason: String| RunEnd::because(RunState::GivenUp, reason);
    if let Some(error) = failed {
        RunEnd::because(RunState::Interrupted, error)
    } else if let Some(reason) = controller.stop_reason() {
        given_up(format!("the hand was stopped: {reason}"))
    } else if controller.phase() == Phase::Done && controller.task().failed() {
        let found = controller.task().outcome().unwrap_or_default();
        given_up(format!(
            "the task ended, but not as it should have: {found}"
        ))
    } else if controller.phase() == Phase::Done {
        RunEnd::DONE
    } else if interrupted {
        RunEnd::because(
            RunState::Interrupted,
            "by Ctrl-C or by the system; the report shows the run so far",
        )
    } else {
        given_up("the task was not done when the experiment's time limit was over".into())
    }
}

/// Closes the recording in `folder` of a run with the duration `wall_time` (s), and generates its report.
///
/// # Errors
/// If the recording or the report cannot be written.
pub fn finish(
    log: RunLog,
    wall_time: f64,
    end: RunEnd,
    folder: &Path,
) -> Result<ReportOutcome, RunError> {
    let mut recorder = log.into_recorder();
    recorder.set_end(end);
    recorder.finish(Some(wall_time))?;
    Ok(make(folder)?)
}
