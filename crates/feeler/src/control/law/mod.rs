//! Control laws: traits for laws that follow a task's plan without losing or crushing the object, and built-in laws.

pub mod best;
mod config;
mod finger_laws;
pub mod missing_shear;
pub mod normal_only;
pub mod open_loop;
pub mod pivot;
pub mod policy;
pub mod tri_axial;

pub use config::{LawConfig, LawError};
pub use finger_laws::FingerLaws;

use super::plan::Plan;
use super::sense::{FingerReadings, HandReadings};
use dyn_clone::DynClone;
use glam::DVec3;
use std::fmt::Debug;

/// Valid range of friction coefficients.
const FRICTION: (f64, f64) = (0.01, 10.0);

/// A control law for one finger. Each finger has a separate instance.
///
/// Laws are part of the control path: they neither allocate nor panic.
pub trait Law: DynClone + Debug + Send {
    /// Returns the velocity of the fingertip until the next control step (m/s, in W).
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3;
}

dyn_clone::clone_trait_object!(Law);

/// A control law for all fingers of a hand together.
///
/// Laws are part of the control path: the methods neither allocate nor panic.
pub trait HandLaw: DynClone + Debug + Send {
    /// Updates the law with the hand's state and forces, before the task plans. Sets for each finger whether it has
    /// closed on the object; `None` leaves that decision to the task. The default does nothing.
    fn observe(&mut self, _hand: &HandReadings<'_>, _closed: &mut [Option<bool>]) {}

    /// Computes the velocity of each fingertip until the next control step (m/s, in W) from its plan.
    fn velocities(&mut self, plans: &[Plan], hand: &HandReadings<'_>, velocities: &mut [DVec3]);
}

dyn_clone::clone_trait_object!(HandLaw);
