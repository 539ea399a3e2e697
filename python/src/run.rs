//! Runs: an experiment, its recording and its report.

use crate::errors::{failed, refused};
use crate::interrupt::interruptible;
use feeler::pace::FreeRunning;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::{FinishedRun, RecordedRun, RunError};
use feeler_lab::experiment::run_folder;
use feeler_record::RunEnd;
use feeler_report::run::make;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Result of a run.
#[pyclass(frozen, get_all, module = "feeler._core")]
pub struct RunOutcome {
    folder: PathBuf,
    /// Content of `summary.json`.
    summary: String,
    state: String,
    reason: Option<String>,
    simulated_time: f64,
    wall_time: f64,
}

/// Runs `experiment` with `settings` and records it in the folder `out`, or in a new folder in `runs`. `progress` is
/// called periodically with the simulated time, s.
#[pyfunction]
#[pyo3(signature = (experiment, settings, out, record_frames, progress))]
pub fn run(
    py: Python<'_>,
    experiment: &str,
    settings: Vec<String>,
    out: Option<PathBuf>,
    record_frames: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<RunOutcome> {
    let experiment = Experiment::load(experiment, &settings).map_err(refused)?;
    let folder = match out {
        Some(out) => run_folder::named(&out).map(|()| out),
        None => run_folder::new(Path::new("runs"), &experiment.config, None),
    };
    let folder = folder.map_err(refused)?;
    let nanoseconds = AtomicU64::new(0);
    let work = |stop: &AtomicBool| -> Result<Option<FinishedRun>, RunError> {
        let run = RecordedRun::new(&experiment, record_frames, &folder)?;
        let closed = run.record(&mut FreeRunning::default(), stop, |control_loop, _, _| {
            let stamp = 1e9 * control_loop.state().stamp;
            nanoseconds.store(stamp as u64, Ordering::Relaxed);
            None
        });
        // After an interrupt, do not delay the exit by writing a report; `feeler report` can write it later.
        match stop.load(Ordering::Relaxed) {
            true => Ok(None),
            false => closed.report().map(Some),
        }
    };
    let finished = interruptible(py, work, |py| {
        let seconds = 1e-9 * nanoseconds.load(Ordering::Relaxed) as f64;
        match &progress {
            Some(progress) => progress.call1(py, (seconds,)).map(|_| ()),
            None => Ok(()),
        }
    })?;
    let finished = finished.map_err(|error| match error {
        RunError::Config(_) | RunError::Experiment(_) | RunError::NoPictures => refused(error),
        RunError::Record(_) | RunError::Report(_) => failed(error),
    })?;
    // A run without a report was interrupted, and the exception was raised above.
    finished.map_or_else(
        || Err(pyo3::exceptions::PyKeyboardInterrupt::new_err(())),
        |finished| {
            let simulated_time = finished.session.control_loop().state().stamp;
            RunOutcome::read(folder, &finished.end, simulated_time, finished.wall_time)
        },
    )
}

impl RunOutcome {
    /// Reads the result of the run in `folder`, whose report must exist.
    pub fn read(
        folder: PathBuf,
        end: &RunEnd,
        simulated_time: f64,
        wall_time: f64,
    ) -> PyResult<Self> {
        Ok(Self {
            summary: std::fs::read_to_string(folder.join(make::SUMMARY))?,
            folder,
            state: end.state.to_string(),
            reason: end.reason.clone(),
            simulated_time,
            wall_time,
        })
    }
}

/// Recreates the report of the run in `folder`.
#[pyfunction]
pub fn report(py: Python<'_>, folder: PathBuf) -> PyResult<()> {
    let made = interruptible(py, |_| make::make(&folder), |_| Ok(()))?;
    made.map(|_| ()).map_err(failed)
}
