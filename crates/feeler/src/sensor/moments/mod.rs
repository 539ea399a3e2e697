//! Zeroth and first moments of each element's sub-region.

pub(crate) mod config;
pub(crate) mod kernel;

pub use config::{MomentsConfig, MomentsError};
pub use kernel::{ElementMoments, Instructions, MomentsKernel};
