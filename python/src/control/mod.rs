//! The control loop of a simulated rig, with optional tasks and laws in Python.

mod own;
mod sense;
mod session;

pub use sense::{FingerSense, HandSense, Plan};
pub use session::Session;
