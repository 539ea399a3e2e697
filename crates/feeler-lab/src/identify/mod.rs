//! Identification of a hand by touch: estimates the properties of fingertips, drives and object from a probing run.
//!
//! [`probing`] replaces an experiment's task by a probe, [`probe`] runs it in the simulator, and [`estimate`] computes
//! estimates from the recorded forces, joint angles and commands. Estimation uses only data that a real hand provides.

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
