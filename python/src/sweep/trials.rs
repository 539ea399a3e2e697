//! The trials of a plan, which may run on any machine.

use crate::errors::refused;
use crate::interrupt::interruptible;
use feeler_lab::config::Experiment;
use feeler_lab::sweep::results::line;
use feeler_lab::sweep::{Plan, trial};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The trials of a sweep.
#[pyclass(frozen, module = "feeler._core")]
pub struct Trials {
    pub(super) trials: Arc<trial::Trials>,
}

#[pymethods]
impl Trials {
    /// Parses a plan, the text of `sweep.toml`. If `folder` is given, it must contain the files that the plan names.
    #[new]
    #[pyo3(signature = (plan, folder))]
    fn new(plan: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let plan = Plan::parse(plan, Path::new(feeler_lab::sweep::plan::PLAN)).map_err(refused)?;
        Self::of(&match folder {
            Some(folder) => plan.with_folder(folder),
            None => plan,
        })
    }

    /// Plans `count` trials of `experiment` with `settings` and the variations `vary`. With `resume`, continues the
    /// interrupted sweep in that folder, which must have the same plan.
    #[staticmethod]
    #[pyo3(signature = (experiment, settings, vary, seed, count, resume))]
    fn planned(
        experiment: &str,
        settings: Vec<String>,
        vary: Vec<String>,
        seed: u64,
        count: u64,
        resume: Option<PathBuf>,
    ) -> PyResult<Self> {
        let name = experiment;
        let experiment = Experiment::load(name, &settings).map_err(refused)?;
        let plan = Plan::new(&experiment, name, &vary, seed, count).map_err(refused)?;
        match resume {
            Some(folder) => Self::of(&plan.resume(&folder).map_err(refused)?),
            None => Self::of(&plan),
        }
    }

    /// The text of `sweep.toml`.
    #[getter]
    fn plan(&self) -> String {
        self.trials.plan().to_toml()
    }

    /// Number of trials.
    #[getter]
    fn count(&self) -> u64 {
        self.trials.plan().trials
    }

    /// Returns the files that trials may read (bytes), by the name that the experiment uses for each.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, bytes) in self.trials.plan().files().map_err(refused)? {
            files.set_item(name, PyBytes::new(py, &bytes))?;
        }
        Ok(files)
    }

    /// Runs the given trials one after the other and returns their rows as a table with a header (CSV). `progress` is
    /// called periodically with the number of finished trials.
    #[pyo3(signature = (trials, progress=None))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        trials: Vec<u64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        if let Some(trial) = trials.iter().find(|&&trial| trial >= self.count()) {
            let count = self.count();
            return Err(PyIndexError::new_err(format!(
                "trial {trial}: expected 0 to {} of {count} trials",
                count - 1
            )));
        }
        let finished = AtomicU64::new(0);
        let work = |stop: &AtomicBool| {
            let mut table = line(&self.trials.header());
            for &trial in &trials {
                // The result of an interrupted trial is discarded.
                let Some(row) = self.trials.run(trial, stop) else {
                    break;
                };
                table.extend(line(&row));
                finished.fetch_add(1, Ordering::Relaxed);
            }
            table
        };
        let watch = |py: Python<'_>| tell(py, progress.as_ref(), &finished);
        Ok(PyBytes::new(py, &interruptible(py, work, watch)?))
    }
}

impl Trials {
    fn of(plan: &Plan) -> PyResult<Self> {
        let trials = trial::Trials::new(plan).map_err(refused)?;
        let trials = Arc::new(trials);
        Ok(Self { trials })
    }
}

/// Passes the number of finished trials to `progress`.
pub(super) fn tell(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    finished: &AtomicU64,
) -> PyResult<()> {
    let finished = finished.load(Ordering::Relaxed);
    progress.map_or(Ok(()), |progress| progress.call1(py, (finished,)).map(drop))
}
