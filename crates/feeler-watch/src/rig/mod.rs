//! State of a rig of several programs, from the messages on its network.

mod heard;
mod programs;
mod watched;

pub use heard::RigMessages;
pub use watched::WatchedRig;
