#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod beacon;
#[cfg(feature = "zenoh")]
pub mod certificates;
pub mod endpoints;
pub mod freshness;
pub mod hand_inbox;
pub mod hand_verdict;
pub mod holds;
pub mod inbox;
mod instruments;
#[cfg(feature = "zenoh")]
mod linger;
pub mod message;
pub mod mismatch;
pub mod network;
pub mod outlet;
pub mod peers;
mod plausible;
pub mod printable;
pub mod programs;
pub mod rejection;
pub mod remote;
pub mod rig_inbox;
pub mod run_clock;
pub mod sense_inbox;
pub mod sequence;
pub mod shared;
mod tactile;
pub mod topic;
#[cfg(feature = "zenoh")]
pub mod transport;
pub mod watch_inbox;
