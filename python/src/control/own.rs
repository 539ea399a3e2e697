//! Tasks and laws implemented in Python.
//!
//! An exception in Python code stops the hand, and is stored for the code that steps the loop.

use super::sense::{FingerSense, HandSense, Plan, Vector, phase};
use feeler::control::law::Law;
use feeler::control::task::{Finding, Task};
use feeler::control::{Phase, StopReason, plan, sense};
use glam::DVec3;
use pyo3::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

/// First exception of Python code in the control loop that has not been re-raised yet.
#[derive(Debug, Clone, Default)]
pub struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    /// Removes and returns the exception, if any.
    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn keep(&self, error: PyErr) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(error);
    }
}

/// A law implemented in Python. Clones share the Python object.
#[derive(Debug, Clone)]
pub struct OwnLaw {
    law: Arc<Py<PyAny>>,
    raised: Raised,
}

impl OwnLaw {
    pub fn new(law: Py<PyAny>, raised: Raised) -> Self {
        let law = Arc::new(law);
        Self { law, raised }
    }
}

impl Law for OwnLaw {
    fn velocity(&mut self, plan: &plan::Plan, finger: &sense::FingerReadings<'_>) -> DVec3 {
        let velocity = Python::attach(|py| {
            let arguments = (Plan(*plan), FingerSense::of(finger));
            let velocity = self.law.call_method1(py, "velocity", arguments)?;
            velocity.extract::<Vector>(py).map(DVec3::from)
        });
        velocity.unwrap_or_else(|error| {
            self.raised.keep(error);
            // NaN makes the controller stop the hand.
            DVec3::NAN
        })
    }
}

/// A task implemented in Python, with its latest state. Clones share the Python object.
#[derive(Debug, Clone)]
pub struct OwnTask {
    task: Arc<Py<PyAny>>,
    raised: Raised,
    phase: Phase,
    stroke: u32,
    findings: Vec<Finding>,
    outcome: Option<&'static str>,
    failed: bool,
}

impl OwnTask {
    pub fn new(py: Python<'_>, task: Py<PyAny>, raised: Raised) -> PyResult<Self> {
        let mut own = Self {
            task: Arc::new(task),
            raised,
            phase: Phase::Search,
            stroke: 1,
            findings: Vec::new(),
            outcome: None,
            failed: false,
        };
        own.ask(py)?;
        Ok(own)
    }

    /// Queries the state of the Python task.
    fn ask(&mut self, py: Python<'_>) -> PyResult<()> {
        let task = self.task.bind(py);
        self.phase = phase(&task.getattr("phase")?.extract::<String>()?)?;
        self.stroke = task.getattr("stroke")?.extract()?;
        self.failed = task.getattr("failed")?.extract()?;
        let outcome: Option<String> = task.getattr("outcome")?.extract()?;
        self.outcome = outcome.map(|outcome| interned(&outcome));
        let findings: BTreeMap<String, f64> = task.getattr("findings")?.extract()?;
        self.findings.clear();
        self.findings
            .extend(findings.iter().map(|(name, &value)| Finding {
                name: interned(name),
                value,
            }));
        Ok(())
    }
}

impl Task for OwnTask {
    fn advance(&mut self, hand: &sense::HandReadings<'_>) -> Result<(), StopReason> {
        let advanced = Python::attach(|py| {
            let hand = HandSense::of(py, hand)?;
            self.task.call_method1(py, "advance", (hand,))?;
            self.ask(py)
        });
        advanced.map_err(|error| {
            let reason = error.to_string();
            self.raised.keep(error);
            StopReason::TaskFailed { reason }
        })
    }

    fn plan(&self, finger: usize, hand: &sense::HandReadings<'_>) -> plan::Plan {
        let plan = Python::attach(|py| {
            let hand = HandSense::of(py, hand)?;
            let plan = self.task.call_method1(py, "plan", (finger, hand))?;
            Ok(plan.extract::<Plan>(py)?.0)
        });
        plan.unwrap_or_else(|error: PyErr| {
            self.raised.keep(error);
            plan::Plan {
                // NaN makes the controller stop the hand.
                velocity: DVec3::NAN,
                ..plan::Plan::default()
            }
        })
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn stroke(&self) -> u32 {
        self.stroke
    }

    fn findings(&self) -> &[Finding] {
        &self.findings
    }

    fn outcome(&self) -> Option<&'static str> {
        self.outcome
    }

    fn failed(&self) -> bool {
        self.failed
    }
}

/// Returns `name` with static lifetime. Leaks each distinct name once; a task has few of them.
fn interned(name: &str) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let kept: &'static str = Box::leak(name.to_string().into_boxed_str());
    names.insert(kept);
    kept
}
