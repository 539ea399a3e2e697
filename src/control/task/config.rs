//! Which task an experiment is about.

use super::Task;
use super::cap::CapTask;
use super::cap_config::Until;
use super::screw::{ScrewConfig, ScrewTask};
use serde::{Deserialize, Serialize};

/// Which task, and everything that it can be tuned by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", try_from = "Tasks")]
pub enum TaskConfig {
    /// Turns something by touching, moving and releasing it, again and again.
    Screw(ScrewConfig),
}

impl TaskConfig {
    /// The task at its beginning.
    pub fn task(&self) -> Box<dyn Task> {
        match self {
            Self::Screw(config) => match (config.until, &config.cap) {
                (Until::Closed | Until::Open, Some(cap)) => Box::new(CapTask::new(config, cap)),
                _ => Box::new(ScrewTask::new(config)),
            },
        }
    }

    /// Its name, as in an experiment file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Screw(_) => "screw",
        }
    }

    /// Where the dome's centre of each finger starts from, m, in W.
    pub fn homes(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Screw(config) => config.finger.iter().map(|path| path.home).collect(),
        }
    }

    /// How many times the fingers touch and release.
    pub fn strokes(&self) -> u32 {
        match self {
            Self::Screw(config) => config.strokes,
        }
    }
}

/// The tasks as a file may have them: one of them. An enum would do, but for its words where a key is unknown.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tasks {
    screw: Option<ScrewConfig>,
}

impl TryFrom<Tasks> for TaskConfig {
    type Error = &'static str;

    fn try_from(tasks: Tasks) -> Result<Self, Self::Error> {
        let mut found = [tasks.screw.map(Self::Screw)].into_iter().flatten();
        match (found.next(), found.next()) {
            (Some(task), None) => Ok(task),
            (None, _) => Err("a task expected, as in [task.screw]; there is none"),
            (Some(_), Some(_)) => Err("one task expected, as in [task.screw]; there are several"),
        }
    }
}
