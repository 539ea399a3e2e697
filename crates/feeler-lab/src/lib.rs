#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod config;
pub mod environment;
pub mod experiment;
pub mod grasps;
pub mod grips;
pub mod identify;
pub mod sensor;
pub mod sweep;
pub mod tune;
