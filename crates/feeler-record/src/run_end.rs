//! How a run ended.

use super::channels::Task;
use feeler::control::phase::Phase;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// Whether a run went on to the end of its task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// The task ended as it should.
    Done,
    /// The task failed, the hand was stopped, or time was up.
    GivenUp,
    /// Somebody ended the run, or its recording is not whole.
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

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunEnd {
    /// Whether it went on to the end of its task.
    pub state: RunState,
    /// Why it did not, if it did not.
    pub reason: Option<String>,
}

impl RunEnd {
    /// Of a run whose task was done.
    pub const DONE: Self = Self {
        state: RunState::Done,
        reason: None,
    };

    /// Of a run that ended otherwise.
    pub fn because(state: RunState, reason: impl Into<String>) -> Self {
        let reason = Some(reason.into());
        Self { state, reason }
    }

    /// That of a recording of a run that ended so, of which something is missing, in words.
    pub(super) fn with_gap(&self, missing: &str) -> Self {
        let why = self.reason.as_deref();
        let why = why.map_or_else(String::new, |why| format!(", {why}"));
        let state = self.state;
        let reason = format!("the recording is not whole: {missing}; the run itself: {state}{why}");
        Self::because(RunState::Interrupted, reason)
    }

    /// Writes it among other entries of a recording's end.
    pub(super) fn write(&self, end: &mut BTreeMap<String, String>) {
        end.insert("state".into(), self.state.key().into());
        if let Some(reason) = &self.reason {
            end.insert("reason".into(), reason.clone());
        }
    }

    /// That of a recording with a `problem` or none, by the entries of its `end`, or by the last state of its task where
    /// they do not say.
    pub(super) fn of(
        problem: Option<&str>,
        last: Option<&Task>,
        end: Option<&BTreeMap<String, String>>,
    ) -> Self {
        if let Some(problem) = problem {
            let reason = format!("the recording is not whole: {problem}");
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
            None => Self::because(RunState::Interrupted, "nothing of the task is on record"),
        })
    }
}
