//! The end of a run: its state and reason.

use super::channels::Task;
use feeler::control::Phase;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// Outcome of a run: whether its task was completed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// The task ended as it should.
    Done,
    /// The task failed, the hand was stopped, or the time limit was reached.
    GivenUp,
    /// The user interrupted the run, or its recording is incomplete.
    Interrupted,
}

impl RunState {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Done, "done"),
        (Self::GivenUp, "given_up"),
        (Self::Interrupted, "interrupted"),
    ];

    fn key(self) -> &'static str {
        let key = Self::ALL.iter().find(|(state, _)| *state == self);
        key.map_or("", |(_, key)| key)
    }
}

impl fmt::Display for RunState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key().replace('_', " "))
    }
}

/// The end of a run: its state and the reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunEnd {
    /// State of the task: done, given up or interrupted.
    pub state: RunState,
    /// Reason why the task was not completed.
    pub reason: Option<String>,
}

impl RunEnd {
    /// The end of a run whose task was completed.
    pub const DONE: Self = Self {
        state: RunState::Done,
        reason: None,
    };

    /// Creates the end of a run whose task was not completed, for this reason.
    pub fn because(state: RunState, reason: impl Into<String>) -> Self {
        let reason = Some(reason.into());
        Self { state, reason }
    }

    /// Converts this end to that of an incomplete recording. `missing` describes the missing messages.
    pub(crate) fn with_gap(&self, missing: &str) -> Self {
        let why = self.reason.as_deref();
        let why = why.map_or_else(String::new, |why| format!(", {why}"));
        let state = self.state;
        let reason =
            format!("the recording is incomplete: {missing}; the run itself: {state}{why}");
        Self::because(RunState::Interrupted, reason)
    }

    /// Writes the end to the metadata of a recording's end.
    pub(crate) fn write(&self, end: &mut BTreeMap<String, String>) {
        end.insert("state".into(), self.state.key().into());
        if let Some(reason) = &self.reason {
            end.insert("reason".into(), reason.clone());
        }
    }

    /// Determines how a run ended: by the recording's `problem`, if any, by its `end` metadata, or else by the `last`
    /// state of its task.
    pub(crate) fn of(
        problem: Option<&str>,
        last: Option<&Task>,
        end: Option<&BTreeMap<String, String>>,
    ) -> Self {
        if let Some(problem) = problem {
            let reason = format!("the recording is incomplete: {problem}");
            return Self::because(RunState::Interrupted, reason);
        }
        let written = end.and_then(|end| {
            let key = end.get("state")?;
            let (state, _) = RunState::ALL.into_iter().find(|(_, name)| name == key)?;
            let reason = end.get("reason").cloned();
            Some(Self { state, reason })
        });
        written.unwrap_or_else(|| match last {
            Some(task) if task.phase == Phase::Done => Self::DONE,
            Some(task) if task.phase == Phase::Stopped => {
                let reason = format!("the hand was stopped: {}", task.reason);
                Self::because(RunState::GivenUp, reason)
            }
            Some(task) => {
                let reason = format!("it ended in {} of stroke {}", task.phase, task.stroke);
                Self::because(RunState::Interrupted, reason)
            }
            None => Self::because(
                RunState::Interrupted,
                "the recording contains no state of the task",
            ),
        })
    }
}
