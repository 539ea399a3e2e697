//! Identification of a hand by touch: what a probing run says about fingertips, drives and object.
//!
//! [`probing`] puts a probe in place of an experiment's task, [`probe`] runs it in the simulator, and [`estimate`] turns the
//! recorded forces, joint angles and commands into estimates. Estimation uses nothing that a real hand lacks.

mod contact;
mod error;
mod estimate;
mod fit;
mod friction;
pub mod identified;
mod lag;
mod noise;
mod page;
mod pivot;
mod probing;
mod stiffness;
pub mod trace;
mod warnings;

pub use error::IdentifyError;
pub use estimate::{EstimateError, Fits, estimate};
pub use identified::{Estimate, FingerEstimates, Identified, ObjectEstimates};
pub use page::page;
pub use probing::{probe, probing};
pub use trace::Trace;
