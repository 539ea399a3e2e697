//! Identification of a hand by touch: what a probing run says about fingertips, drives and object.

pub mod identified;

pub use identified::{Estimate, FingerEstimates, Identified, ObjectEstimates};
