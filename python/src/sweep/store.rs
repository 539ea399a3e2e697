//! A sweep's folder, to which rows are added as trials finish.

use super::trials::{Trials, tell};
use crate::errors::{failed, refused};
use crate::interrupt::{abandonable, interruptible};
use feeler_lab::sweep::results::{store, summary};
use feeler_lab::sweep::{Progress, engine, trial};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

/// The folder of a sweep, to which rows can be added.
#[pyclass(frozen, module = "feeler._core")]
pub struct Store {
    trials: Arc<trial::Trials>,
    folder: PathBuf,
    /// `None` once the sweep is finished.
    store: Arc<Mutex<Option<store::Store>>>,
}

#[pymethods]
impl Store {
    /// Creates the folder of `trials`. With `resume`, opens the folder in which they were interrupted.
    #[new]
    #[pyo3(signature = (folder, trials, resume))]
    fn new(folder: PathBuf, trials: &Trials, resume: bool) -> PyResult<Self> {
        let trials = Arc::clone(&trials.trials);
        let (plan, header) = (trials.plan(), trials.header());
        let store = match resume {
            true => store::Store::resume(&folder, plan, header),
            false => store::Store::create(&folder, plan, header),
        };
        Ok(Self {
            store: Arc::new(Mutex::new(Some(store.map_err(refused)?))),
            trials,
            folder,
        })
    }

    /// Number of finished trials.
    #[getter]
    fn finished(&self) -> PyResult<usize> {
        let mut store = lock(&self.store)?;
        Ok(open(&mut store)?.table.rows.len())
    }

    /// Returns the unfinished trials.
    fn missing(&self) -> PyResult<Vec<u64>> {
        let mut store = lock(&self.store)?;
        Ok(open(&mut store)?.missing(self.trials.plan(), u64::MAX))
    }

    /// Adds rows as returned by `Trials.run`.
    fn push(&self, rows: &[u8]) -> PyResult<()> {
        let mut store = lock(&self.store)?;
        let plan = self.trials.plan();
        open(&mut store)?.push_table(plan, rows).map_err(failed)
    }

    /// Runs the missing trials in this process, `jobs` at a time, by default one per core. `progress` is called
    /// periodically with the number of finished trials.
    #[pyo3(signature = (jobs, progress))]
    fn run(
        &self,
        py: Python<'_>,
        jobs: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let jobs = jobs.unwrap_or_else(cores);
        let finished = Arc::new(AtomicU64::new(self.finished()? as u64));
        let (trials, store) = (Arc::clone(&self.trials), Arc::clone(&self.store));
        let mut count = Count(Arc::clone(&finished));
        let work = move |stop: &AtomicBool| {
            let mut store = lock(&store)?;
            let ran = engine::run(&trials, open(&mut store)?, u64::MAX, jobs, stop, &mut count);
            ran.map_err(failed)
        };
        // Setting up a trial's sensors may take longer than Ctrl-C should be delayed.
        abandonable(py, work, |py| tell(py, progress.as_ref(), &finished))??;
        tell(py, progress.as_ref(), &finished)
    }

    /// Replaces the table of rows in order of completion by the sorted table, and writes the page.
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        let mut store = lock(&self.store)?;
        let missing = open(&mut store)?.missing(self.trials.plan(), u64::MAX);
        if let (count, Some(first)) = (missing.len(), missing.first()) {
            return Err(PyRuntimeError::new_err(format!(
                "cannot finish: {count} trials are missing, starting with trial {first}"
            )));
        }
        let Some(whole) = store.take() else {
            return Err(closed());
        };
        let (folder, trials) = (&self.folder, &self.trials);
        let finish = |_: &AtomicBool| summary::write(folder, trials, &whole.finish()?);
        interruptible(py, finish, |_| Ok(()))?.map_err(failed)
    }
}

/// Locks the store. Fails if another thread has locked it. Waiting would deadlock if that thread needs the interpreter
/// to finish.
fn lock(store: &Mutex<Option<store::Store>>) -> PyResult<MutexGuard<'_, Option<store::Store>>> {
    store.try_lock().map_err(|error| {
        PyRuntimeError::new_err(match error {
            TryLockError::WouldBlock => "the sweep is already running on another thread",
            TryLockError::Poisoned(_) => "the sweep has failed; create it again and resume",
        })
    })
}

fn open(store: &mut Option<store::Store>) -> PyResult<&mut store::Store> {
    store.as_mut().ok_or_else(closed)
}

fn closed() -> PyErr {
    PyRuntimeError::new_err("the sweep is finished; start a new one")
}

/// Number of finished trials, readable from another thread.
struct Count(Arc<AtomicU64>);

impl Progress for Count {
    fn show(&mut self, finished: u64, _: u64, _: u64) {
        self.0.store(finished, Ordering::Relaxed);
    }
}
