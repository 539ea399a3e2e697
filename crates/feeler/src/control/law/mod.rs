//! How a finger does what the task wants without losing or crushing what it touches: the trait of every
//! control law, and the laws that come with the program.

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
use super::sense::{FingerSense, HandSense};
use dyn_clone::DynClone;
use glam::DVec3;
use std::fmt::Debug;

/// Coefficients of friction that anything could have.
const FRICTION: (f64, f64) = (0.01, 10.0);

/// From one finger's plan and what it feels to its velocity; each finger has a law of its own.
///
/// It is part of the control path: it neither allocates nor panics.
pub trait Law: DynClone + Debug + Send {
    /// Velocity of the fingertip until the next control step, m/s, in W.
    fn velocity(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3;
}

dyn_clone::clone_trait_object!(Law);

/// A control law for all fingers of a hand together.
///
/// It is part of the control path: its methods neither allocate nor panic.
pub trait HandLaw: DynClone + Debug + Send {
    /// Updates the law with the hand's state and forces, before the task plans. Writes for each finger whether it has
    /// closed on the object; `None` leaves that decision to the task. The default does nothing.
    fn observe(&mut self, _hand: &HandSense<'_>, _closed: &mut [Option<bool>]) {}

    /// Writes the velocity of each fingertip until the next control step, m/s, in W, from its plan in `plans`.
    fn velocities(&mut self, plans: &[Plan], hand: &HandSense<'_>, velocities: &mut [DVec3]);
}

dyn_clone::clone_trait_object!(HandLaw);
