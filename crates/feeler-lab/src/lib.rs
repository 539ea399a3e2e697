//! Experiments with feeler: the experiment file, one run in one process, and many randomised trials.

#![warn(missing_docs)]

pub mod config;
pub mod experiment;
pub mod sweep;
