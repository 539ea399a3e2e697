//! How a finger does what the task wants without losing or crushing what it touches: the trait of every
//! control law, and the laws that come with the program.

pub mod tri_axial;

use super::controller::ControlConfig;
use super::plan::Plan;
use super::sense::FingerSense;
use dyn_clone::DynClone;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use tri_axial::{FingerSpeedEstimator, Reflex};

/// From one finger's plan and what it feels to its velocity; each finger has a law of its own.
///
/// It is part of the control path: it neither allocates nor panics.
pub trait Law: DynClone + Debug + Send {
    /// Velocity of the fingertip until the next control step, m/s, in W.
    fn velocity(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3;
}

dyn_clone::clone_trait_object!(Law);

/// Which control law.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawConfig {
    /// The paper's (Fig. 5): re-compression on slip, which tri-axial forces show.
    #[default]
    TriAxial,
}

impl LawConfig {
    /// The law for one finger, at rest, with what `control` tunes it by.
    pub fn law(&self, control: &ControlConfig) -> Box<dyn Law> {
        match self {
            Self::TriAxial => Box::new(FingerSpeedEstimator::new(Reflex {
                recompression_speed: control.recompression_speed,
                minimum_grasp_force: control.minimum_grasp_force,
            })),
        }
    }
}
