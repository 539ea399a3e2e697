//! What a hand does: the trait of every task, and the tasks that come with the program.
//!
//! A task is a small state machine. It says where each finger should go; how a finger gets there without
//! losing or crushing what it holds is the [law](super::law)'s work, and what it may never do the
//! [limits](super::limits)'.

/// The values of keys that a file may leave out, beside keys that it may not: a module of functions for
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

pub mod cap;
pub mod cap_config;
mod cap_touch;
mod cap_verdict;
pub mod carry;
mod config;
pub mod contour;
pub mod friction_scan;
mod homing;
pub mod probe;
pub mod screw;
mod screw_config;
mod search;
pub mod surface;

pub use config::TaskConfig;

use super::phase::Phase;
use super::plan::Plan;
use super::sense::HandSense;
use super::stop_reason::StopReason;
use dyn_clone::DynClone;
use std::fmt::Debug;

/// From what all fingers feel to what each of them is to do.
///
/// In every control step [`advance`](Self::advance) comes first, then [`plan`](Self::plan) for each finger. While
/// the hand is stopped, a task is not asked; afterwards it goes on where it was. Its methods are part of the control path:
/// they neither allocate nor panic.
pub trait Task: DynClone + Debug + Send {
    /// Takes in what the fingers feel, and goes on to the next phase where it is time to.
    ///
    /// # Errors
    /// Why the task has to be given up.
    fn advance(&mut self, hand: &HandSense<'_>) -> Result<(), StopReason>;

    /// What finger `finger` is to do.
    fn plan(&self, finger: usize, hand: &HandSense<'_>) -> Plan;

    /// Where the task stands; [`Phase::Done`] ends the run.
    fn phase(&self) -> Phase;

    /// How many times the fingers have begun to touch and release, from 1.
    fn stroke(&self) -> u32 {
        1
    }

    /// What the task found out so far, always in the same order.
    fn findings(&self) -> &[Finding] {
        &[]
    }

    /// What came of the task, in a few words ("closed", "no cap"), once it can tell.
    fn outcome(&self) -> Option<&'static str> {
        None
    }

    /// Whether what came of the task is something else than it was for.
    fn failed(&self) -> bool {
        false
    }
}

dyn_clone::clone_trait_object!(Task);

/// One thing that a task found out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// What it is called, with its unit where it has one: `static_friction`, `torque_nm`.
    pub name: &'static str,
    /// Its value, in SI units.
    pub value: f64,
}
