//! How a finger does what the task wants without losing or crushing what it touches: the trait of every
//! control law, and the laws that come with the program.

pub mod best;
mod config;
pub mod missing_shear;
pub mod normal_only;
pub mod open_loop;
pub mod policy;
pub mod tri_axial;

pub use config::{LawConfig, LawError};

use super::plan::Plan;
use super::sense::FingerSense;
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
