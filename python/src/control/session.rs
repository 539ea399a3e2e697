//! A run that Python code steps.

use super::own::{OwnLaw, OwnTask, Raised};
use super::sense::{HandSense, Plan};
use crate::errors::{failed, refused};
use crate::run::RunOutcome;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::{finish, record_options, run_end};
use feeler_lab::experiment::{self, Instruments, Pictures, run_folder};
use feeler_record::{Recorder, RunLog};
use feeler_report::run::make::RECORDING;
use glam::DVec3;
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::time::Instant;

/// A control loop in progress, with its recording.
#[pyclass(frozen, module = "feeler._core")]
pub struct Session {
    stepped: Mutex<Stepped>,
    raised: Raised,
    fingers: usize,
    period: f64,
}

struct Stepped {
    session: experiment::Session,
    log: Option<(RunLog, PathBuf)>,
    /// Instrument readings at the start of the current step.
    instruments: Option<Instruments>,
    start: Instant,
}

#[pymethods]
impl Session {
    /// Creates a session of `experiment` with `settings`, recorded in the folder `out` if given. `task`, in which the
    /// fingers start from `homes`, and `law` replace those of the experiment.
    #[new]
    #[pyo3(signature = (experiment, settings, out, task, homes, law))]
    fn new(
        py: Python<'_>,
        experiment: &str,
        settings: Vec<String>,
        out: Option<PathBuf>,
        task: Option<Py<PyAny>>,
        homes: Option<Vec<[f64; 3]>>,
        law: Option<Vec<Py<PyAny>>>,
    ) -> PyResult<Self> {
        let experiment = Experiment::load(experiment, &settings).map_err(refused)?;
        let raised = Raised::default();
        let config = &experiment.config;
        let homes = homes.unwrap_or_else(|| config.task.homes());
        let task = match task {
            Some(task) => Box::new(OwnTask::new(py, task, raised.clone())?),
            None => config.task.task(),
        };
        // Python code receives forces only, so other images are not rendered.
        let session =
            experiment::Session::with_task_rendering(&experiment, task, &homes, Pictures::Sensed);
        let mut session = session.map_err(refused)?;
        if let Some(laws) = law {
            let own = |finger: usize| {
                OwnLaw::new(laws[finger % laws.len()].clone_ref(py), raised.clone())
            };
            session.set_laws(|finger| Box::new(own(finger)));
        }
        let log = out.map(|out| log(&experiment, &session, out)).transpose()?;
        Ok(Self {
            fingers: config.hand.finger.len(),
            period: config.control.period,
            raised,
            stepped: Mutex::new(Stepped {
                session,
                log,
                instruments: None,
                start: Instant::now(),
            }),
        })
    }

    /// Control period, s.
    #[getter]
    fn period(&self) -> f64 {
        self.period
    }

    /// Reads hand and sensors and updates the task. Returns the readings of the hand and the plan of each finger, or
    /// `None` once the run is finished.
    fn plan(&self, py: Python<'_>) -> PyResult<Option<(HandSense, Vec<Plan>)>> {
        let mut stepped = self.stepped()?;
        if stepped.instruments.is_some() {
            return Err(PyRuntimeError::new_err(
                "act was not called for the current step; call it before the next plan",
            ));
        }
        if stepped.session.finished() {
            return Ok(None);
        }
        stepped.instruments = Some(stepped.session.instruments());
        stepped.session.plan().map_err(failed)?;
        self.raise()?;
        let control_loop = stepped.session.control_loop();
        let hand = HandSense::of(py, &control_loop.hand_sense())?;
        let plans = control_loop.controller().plans().iter();
        Ok(Some((hand, plans.copied().map(Plan).collect())))
    }

    /// Moves the fingers at `velocity` [F, 3], m/s in W; if it is `None`, as the control laws command.
    fn act(&self, velocity: Option<PyReadonlyArray2<'_, f64>>) -> PyResult<()> {
        let mut stepped = self.stepped()?;
        let Some(instruments) = stepped.instruments.take() else {
            return Err(PyRuntimeError::new_err(
                "no step is in progress; call plan first",
            ));
        };
        match velocity {
            None => stepped.session.act_with_laws(),
            Some(velocity) => {
                let velocity = velocity.as_slice()?.chunks_exact(3).map(DVec3::from_slice);
                let velocity: Vec<_> = velocity.take(self.fingers).collect();
                stepped.session.follow(&velocity)
            }
        }
        .map_err(failed)?;
        let Stepped { session, log, .. } = &mut *stepped;
        if let Some((log, _)) = log {
            let recorded = instruments.record(session.control_loop(), log);
            recorded.map_err(failed)?;
        }
        self.raise()
    }

    /// Returns the phase of the task, the stroke, and the reason of a stop, if any.
    fn stands(&self) -> PyResult<(String, u32, Option<String>)> {
        let stepped = self.stepped()?;
        let controller = stepped.session.control_loop().controller();
        let reason = controller.stop_reason().map(ToString::to_string);
        let stroke = controller.task().stroke();
        Ok((controller.phase().to_string(), stroke, reason))
    }

    /// Returns the findings of the task so far by name, and its outcome.
    fn findings(&self) -> PyResult<(Vec<(&'static str, f64)>, Option<&'static str>)> {
        let stepped = self.stepped()?;
        let task = stepped.session.control_loop().controller().task();
        let findings = task.findings().iter().map(|f| (f.name, f.value));
        Ok((findings.collect(), task.outcome()))
    }

    /// Stops the hand; `by` names the source of the request.
    fn stop(&self, by: &str) -> PyResult<()> {
        self.stepped()?.session.stop(by);
        Ok(())
    }

    /// Resumes after a stop.
    fn resume(&self) -> PyResult<()> {
        self.stepped()?.session.resume();
        Ok(())
    }

    /// Closes the recording, if any, and writes its report.
    fn close(&self, py: Python<'_>, interrupted: bool) -> PyResult<Option<RunOutcome>> {
        let mut stepped = self.stepped()?;
        let Some((log, folder)) = stepped.log.take() else {
            return Ok(None);
        };
        let control_loop = stepped.session.control_loop();
        let simulated_time = control_loop.state().stamp;
        let wall_time = stepped.start.elapsed().as_secs_f64();
        let end = run_end(None, control_loop.controller(), interrupted);
        let closing = end.clone();
        let made = py.detach(|| finish(log, wall_time, closing, &folder));
        made.map_err(failed)?;
        RunOutcome::read(folder, &end, simulated_time, wall_time).map(Some)
    }
}

impl Session {
    /// Returns an error if a task or law calls its own session, or if another thread uses the session.
    fn stepped(&self) -> PyResult<MutexGuard<'_, Stepped>> {
        match self.stepped.try_lock() {
            Ok(stepped) => Ok(stepped),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "the session is in the middle of a step; call it between steps only",
            )),
        }
    }

    fn raise(&self) -> PyResult<()> {
        self.raised.take().map_or(Ok(()), Err)
    }
}

/// Creates a recording of `session` in the folder `out`.
fn log(
    experiment: &Experiment,
    session: &experiment::Session,
    out: PathBuf,
) -> PyResult<(RunLog, PathBuf)> {
    let options = record_options(experiment, false).map_err(refused)?;
    run_folder::named(&out).map_err(refused)?;
    let facts = session.facts(&experiment.config);
    let file = out.join(RECORDING);
    let recorder = Recorder::create_with(file, &facts, &experiment.toml, &options);
    let log = RunLog::new(recorder.map_err(failed)?, &facts).map_err(failed)?;
    Ok((log, out))
}
