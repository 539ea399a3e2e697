//! Tasks of a hand: the [`Task`] trait and the built-in tasks.
//!
//! A task is a state machine that plans each finger's motion. The [law](super::law) determines how a finger follows
//! the plan without losing or crushing the object, and the limits restrict every command.

/// Defines default values for optional keys of a table that also has required keys: a module of functions for
/// `#[serde(default = "default::key")]`. A table without required keys has a [`Default`] instead.
macro_rules! defaults {
    ($($key:ident: $type:ty = $value:expr),* $(,)?) => {
        mod default {
            $(pub(super) fn $key() -> $type {
                $value
            })*
        }
    };
}

/// Implements methods of [`Task`] that return the field of the same name.
macro_rules! accessors {
    (@phase) => {
        fn phase(&self) -> $crate::control::phase::Phase {
            self.phase
        }
    };
    (@stroke) => {
        fn stroke(&self) -> u32 {
            self.stroke
        }
    };
    (@findings) => {
        fn findings(&self) -> &[$crate::control::task::Finding] {
            &self.findings
        }
    };
    (@outcome) => {
        fn outcome(&self) -> Option<&'static str> {
            self.outcome
        }
    };
    ($($field:ident),+) => {
        $(accessors!(@$field);)+
    };
}

pub mod cap;
pub mod cap_config;
mod cap_estimator;
pub mod carry;
mod config;
pub mod contour;
pub mod follow;
pub mod friction_scan;
pub mod grip;
mod homing;
pub mod probe;
mod resistance_curve;
pub mod screw;
mod screw_config;
mod search;
pub mod surface;

pub use config::TaskConfig;

use super::phase::Phase;
use super::plan::Plan;
use super::sense::HandReadings;
use super::stop_reason::StopReason;
use dyn_clone::DynClone;
use std::fmt::Debug;

/// Plans the motion of all fingers from their readings.
///
/// In every control step, [`advance`](Self::advance) is called first, then [`plan`](Self::plan) for each finger. A
/// task is not called while the hand is stopped, and continues from the same state afterwards. The methods are part
/// of the control path: they neither allocate nor panic.
pub trait Task: DynClone + Debug + Send {
    /// Updates the task with the readings of all fingers, and starts the next phase when due.
    ///
    /// # Errors
    /// If the task cannot continue.
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason>;

    /// Planned motion of finger `finger`.
    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan;

    /// Current phase; [`Phase::Done`] ends the run.
    fn phase(&self) -> Phase;

    /// Number of the current cycle of touching and releasing, from 1.
    fn stroke(&self) -> u32 {
        1
    }

    /// Findings of the task so far, always in the same order.
    fn findings(&self) -> &[Finding] {
        &[]
    }

    /// Outcome of the task in a few words ("closed", "no cap"), or `None` while it is unknown.
    fn outcome(&self) -> Option<&'static str> {
        None
    }

    /// Returns whether the outcome is a failure.
    fn failed(&self) -> bool {
        false
    }
}

dyn_clone::clone_trait_object!(Task);

/// A quantity that a task has measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Name, with the unit if any: `static_friction`, `torque_nm`.
    pub name: &'static str,
    /// Value in SI units.
    pub value: f64,
}

impl Finding {
    /// A finding that has not been measured yet.
    fn unknown(name: &'static str) -> Self {
        let value = f64::NAN;
        Self { name, value }
    }
}
