//! Identification of a hand by touch: what a probing run says about fingertips, drives and object.

mod error;
pub mod identified;
mod probing;
pub mod trace;

pub use error::IdentifyError;
pub use identified::{Estimate, FingerEstimates, Identified, ObjectEstimates};
pub use probing::{probe, probing};
pub use trace::Trace;
