//! The control loop of a simulated rig, with tasks and laws that may be Python's.

mod own;
mod sense;
mod session;

pub use sense::{FingerSense, HandSense, Plan};
pub use session::Session;
