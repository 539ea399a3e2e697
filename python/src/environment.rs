//! Environments for reinforcement learning, single and vectorised on threads.

use crate::errors::{failed, refused};
use feeler_lab::environment::{
    ActionKind, Autoreset, Batch, Environment, EnvironmentConfig, EnvironmentError,
    VectorEnvironment, VectorError,
};
use numpy::{
    PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1, PyReadwriteArray2, PyReadwriteArray3,
    PyUntypedArrayMethods as _,
};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::process;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Layout and ranges of an environment's arrays.
#[pyclass(frozen, get_all, module = "feeler._core")]
pub struct EnvironmentSpec {
    /// Parts of each finger's observation: name, unit, start index and end index.
    parts: Vec<Vec<(&'static str, &'static str, usize, usize)>>,
    /// Maximum magnitude of each component of an action that is executed unchanged; larger ones are limited.
    action_bounds: Vec<f64>,
    /// Minimum of each component of an observation.
    low: Vec<f32>,
    /// Maximum of each component of an observation.
    high: Vec<f32>,
    /// Names of the values reported in addition to the reward, with units.
    info_names: Vec<&'static str>,
    /// Control period, s.
    period: f64,
    /// Maximum number of control steps of an episode.
    max_steps: u64,
}

impl EnvironmentSpec {
    fn of(environment: &Environment) -> Self {
        let mut start = 0;
        let parts = environment.layouts().iter().map(|layout| {
            let first = start;
            start += layout.len();
            let part = |part: feeler::control::ObservationPart| {
                let range = part.range;
                (part.name, part.unit, first + range.start, first + range.end)
            };
            layout.parts().into_iter().map(part).collect()
        });
        let config = &environment.experiment().config;
        let period = config.control.period;
        let (low, high) = environment.observation_bounds();
        Self {
            low,
            high,
            parts: parts.collect(),
            action_bounds: environment.action_bounds(),
            info_names: environment.info_names(),
            period,
            max_steps: (config.time_limit / period).ceil() as u64,
        }
    }
}

fn config(
    experiment: &str,
    settings: Vec<String>,
    vary: Vec<String>,
    action: &str,
) -> PyResult<EnvironmentConfig> {
    let kind = ActionKind::named(action).ok_or_else(|| {
        let names = ActionKind::NAMES.join(", ");
        PyValueError::new_err(format!("action = {action:?}: expected one of {names}"))
    })?;
    Ok(EnvironmentConfig {
        experiment: experiment.into(),
        settings,
        vary,
        action: kind,
    })
}

/// An environment that runs an experiment in episodes.
#[pyclass(frozen, module = "feeler._core")]
pub struct SingleEnvironment(Mutex<Environment>);

#[pymethods]
impl SingleEnvironment {
    #[new]
    fn new(
        experiment: &str,
        settings: Vec<String>,
        vary: Vec<String>,
        action: &str,
    ) -> PyResult<Self> {
        let config = config(experiment, settings, vary, action)?;
        let environment = Environment::new(&config).map_err(refused)?;
        Ok(Self(Mutex::new(environment)))
    }

    fn spec(&self) -> PyResult<EnvironmentSpec> {
        Ok(EnvironmentSpec::of(&*lock(&self.0)?))
    }

    /// Begins the episode of `seed`; if it is `None`, the seed is derived from the last given one. Returns the seed.
    fn reset(
        &self,
        py: Python<'_>,
        seed: Option<u64>,
        mut observation: PyReadwriteArray1<'_, f32>,
        mut info: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<u64> {
        let mut guard = lock(&self.0)?;
        let environment = &mut *guard;
        let seed = py.detach(|| environment.reset(seed)).map_err(refused)?;
        copy(environment.observation(), observation.as_slice_mut()?)?;
        copy(environment.info(), info.as_slice_mut()?)?;
        Ok(seed)
    }

    /// Begins the episode that would follow after `following` resets without a seed, starting from the episode of
    /// `seed`. Returns its seed.
    fn reset_to(
        &self,
        py: Python<'_>,
        seed: u64,
        following: u64,
        mut observation: PyReadwriteArray1<'_, f32>,
        mut info: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<u64> {
        let mut guard = lock(&self.0)?;
        let environment = &mut *guard;
        let seed = py.detach(|| environment.reset_to(seed, following));
        let seed = seed.map_err(refused)?;
        copy(environment.observation(), observation.as_slice_mut()?)?;
        copy(environment.info(), info.as_slice_mut()?)?;
        Ok(seed)
    }

    /// Runs one control step. Returns the reward, terminated and truncated.
    fn step(
        &self,
        py: Python<'_>,
        action: PyReadonlyArray1<'_, f64>,
        mut observation: PyReadwriteArray1<'_, f32>,
        mut info: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<(f64, bool, bool)> {
        let action = action.as_slice()?;
        let mut guard = lock(&self.0)?;
        let environment = &mut *guard;
        let step = py.detach(|| environment.step(action)).map_err(step_error)?;
        copy(environment.observation(), observation.as_slice_mut()?)?;
        copy(environment.info(), info.as_slice_mut()?)?;
        Ok((step.reward, step.terminated, step.truncated))
    }

    /// Writes the action that executes the task's plan.
    fn guide(&self, mut action: PyReadwriteArray1<'_, f64>) -> PyResult<()> {
        let environment = lock(&self.0)?;
        environment.guide(action.as_slice_mut()?).map_err(refused)
    }

    /// Renders the current scene into `picture` [H, W, 3].
    fn render(&self, py: Python<'_>, mut picture: PyReadwriteArray3<'_, u8>) -> PyResult<()> {
        let size = (picture.shape()[1], picture.shape()[0]);
        let rgb = picture.as_slice_mut()?;
        let mut guard = lock(&self.0)?;
        let environment = &mut *guard;
        py.detach(move || environment.render(size, rgb))
            .map_err(refused)
    }

    /// Reason why the hand was stopped, or `None` if it is not stopped.
    fn stop_reason(&self) -> PyResult<Option<String>> {
        Ok(lock(&self.0)?.stop_reason().map(ToString::to_string))
    }
}

/// Environments that are stepped together, on threads.
#[pyclass(frozen, module = "feeler._core")]
pub struct ManyEnvironments {
    environments: Mutex<VectorEnvironment>,
    process: u32,
}

/// Output arrays of n environments: observations [n, L], rewards [n], terminated [n], truncated [n], infos [n, I].
#[derive(FromPyObject)]
pub struct Results<'py>(
    PyReadwriteArray2<'py, f32>,
    PyReadwriteArray1<'py, f64>,
    PyReadwriteArray1<'py, bool>,
    PyReadwriteArray1<'py, bool>,
    PyReadwriteArray2<'py, f64>,
);

impl Results<'_> {
    fn batch(&mut self) -> PyResult<Batch<'_>> {
        Ok(Batch {
            observations: self.0.as_slice_mut()?,
            rewards: self.1.as_slice_mut()?,
            terminated: self.2.as_slice_mut()?,
            truncated: self.3.as_slice_mut()?,
            infos: self.4.as_slice_mut()?,
        })
    }
}

#[pymethods]
impl ManyEnvironments {
    #[new]
    fn new(
        py: Python<'_>,
        experiment: &str,
        settings: Vec<String>,
        vary: Vec<String>,
        action: &str,
        count: usize,
        threads: usize,
        autoreset: &str,
    ) -> PyResult<Self> {
        let autoreset = match autoreset {
            "NextStep" => Autoreset::NextStep,
            "SameStep" => Autoreset::SameStep,
            "Disabled" => Autoreset::Disabled,
            other => {
                return Err(PyValueError::new_err(format!(
                    "autoreset_mode = {other:?}: expected one of NextStep, SameStep, Disabled"
                )));
            }
        };
        let config = config(experiment, settings, vary, action)?;
        let made = py.detach(|| VectorEnvironment::new(&config, count, threads, autoreset));
        Ok(Self {
            environments: Mutex::new(made.map_err(refused)?),
            process: process::id(),
        })
    }

    fn spec(&self) -> PyResult<EnvironmentSpec> {
        self.lock()?.look(0, EnvironmentSpec::of).map_err(failed)
    }

    /// Begins an episode in each environment, or in each for which `mask` is `true`.
    fn reset(
        &self,
        py: Python<'_>,
        seeds: Vec<Option<u64>>,
        mask: Option<PyReadonlyArray1<'_, bool>>,
        mut results: Results<'_>,
    ) -> PyResult<()> {
        let mut guard = self.lock()?;
        let environments = &mut *guard;
        let mask = mask.as_ref().map(|mask| mask.as_slice()).transpose()?;
        let mut batch = results.batch()?;
        let reset = py.detach(|| environments.reset(&seeds, mask, &mut batch));
        reset.map_err(refused)
    }

    /// Runs one control step in each environment, with `actions` [n, A].
    fn step(
        &self,
        py: Python<'_>,
        actions: PyReadonlyArray2<'_, f64>,
        mut results: Results<'_>,
    ) -> PyResult<()> {
        let mut guard = self.lock()?;
        let environments = &mut *guard;
        let actions = actions.as_slice()?;
        let mut batch = results.batch()?;
        let stepped = py.detach(|| environments.step(actions, &mut batch));
        stepped.map_err(vector_error)
    }

    /// If the latest step ended an episode of environment `index` and began another, writes the final observation and
    /// info of the ended episode and returns `true`.
    fn last(
        &self,
        index: usize,
        mut observation: PyReadwriteArray1<'_, f32>,
        mut info: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<bool> {
        let environments = self.lock()?;
        let last = environments.last(index, observation.as_slice_mut()?, info.as_slice_mut()?);
        last.map_err(refused)
    }

    /// Writes the actions [n, A] that execute the tasks' plans.
    fn guide(&self, mut actions: PyReadwriteArray2<'_, f64>) -> PyResult<()> {
        let environments = self.lock()?;
        let rows = actions
            .as_slice_mut()?
            .chunks_exact_mut(environments.action_len());
        for (index, row) in rows.enumerate() {
            let guided = environments.look(index, |environment| environment.guide(row));
            guided.map_err(refused)?.map_err(refused)?;
        }
        Ok(())
    }

    /// Renders the current scene of environment `index` into `picture` [H, W, 3].
    fn render(&self, index: usize, mut picture: PyReadwriteArray3<'_, u8>) -> PyResult<()> {
        let size = (picture.shape()[1], picture.shape()[0]);
        let rgb = picture.as_slice_mut()?;
        let drawn = self
            .lock()?
            .look(index, |environment| environment.render(size, rgb));
        drawn.map_err(refused)?.map_err(refused)
    }

    /// Reason why the hand of environment `index` was stopped, or `None` if it is not stopped.
    fn stop_reason(&self, index: usize) -> PyResult<Option<String>> {
        let reason = |environment: &Environment| environment.stop_reason().map(ToString::to_string);
        self.lock()?.look(index, reason).map_err(refused)
    }
}

impl ManyEnvironments {
    /// Locks the environments. Fails in a forked process, which lacks the threads of its parent.
    fn lock(&self) -> PyResult<MutexGuard<'_, VectorEnvironment>> {
        if process::id() != self.process {
            return Err(PyRuntimeError::new_err(
                "the environments were created before this process was forked, and it lacks their threads; create them after the fork, or start processes with the method \"spawn\"",
            ));
        }
        lock(&self.environments)
    }
}

/// Returns `true` if the action is invalid, which is the caller's error. All other errors are failures of the episode.
fn is_of_action(error: &EnvironmentError) -> bool {
    matches!(
        error,
        EnvironmentError::ActionLength { .. } | EnvironmentError::ActionNotFinite { .. }
    )
}

fn step_error(error: EnvironmentError) -> PyErr {
    match is_of_action(&error) {
        true => refused(error),
        false => failed(error),
    }
}

fn vector_error(error: VectorError) -> PyErr {
    match &error {
        VectorError::Environment { source, .. } if is_of_action(source) => refused(error),
        VectorError::Count { .. } => refused(error),
        _ => failed(error),
    }
}

/// Locks the environment. Fails if another thread is stepping it.
fn lock<T>(mutex: &Mutex<T>) -> PyResult<MutexGuard<'_, T>> {
    match mutex.try_lock() {
        Ok(guard) => Ok(guard),
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
            "another thread is stepping the environment; expected one at a time",
        )),
    }
}

fn copy<T: Copy>(from: &[T], to: &mut [T]) -> PyResult<()> {
    if from.len() != to.len() {
        return Err(PyValueError::new_err(format!(
            "expected an array of {} numbers, got {}",
            from.len(),
            to.len()
        )));
    }
    to.copy_from_slice(from);
    Ok(())
}
