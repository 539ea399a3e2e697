#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod beacon;
#[cfg(feature = "zenoh")]
mod certificate_error;
#[cfg(feature = "zenoh")]
mod certificate_list;
#[cfg(feature = "zenoh")]
pub mod certificates;
pub mod endpoints;
pub mod freshness;
pub mod hand_client;
pub mod hand_inbox;
pub mod hand_verdict;
mod heartbeat;
pub mod holds;
pub mod inbox;
mod instruments;
#[cfg(feature = "zenoh")]
mod linger;
pub mod message;
pub mod mismatch;
pub mod network;
pub mod order;
pub mod outlet;
#[cfg(feature = "zenoh")]
pub mod own_certificate;
mod own_stop;
pub mod peers;
mod plausible;
pub mod printable;
pub mod programs;
#[cfg(feature = "zenoh")]
pub mod register;
pub mod rejection;
pub mod remote;
pub mod rig_inbox;
pub mod right;
pub mod rights;
pub mod run_clock;
pub mod sense_inbox;
pub mod sequence;
pub mod shared;
#[cfg(feature = "zenoh")]
pub mod stop_call;
#[cfg(feature = "zenoh")]
pub mod stop_door;
#[cfg(feature = "zenoh")]
pub mod stop_guard;
#[cfg(feature = "zenoh")]
pub mod stop_proof;
pub mod stop_wire;
mod tactile;
pub mod topic;
#[cfg(feature = "zenoh")]
pub mod transport;
#[cfg(feature = "zenoh")]
mod transport_settings;
#[cfg(feature = "zenoh")]
pub mod validity;
pub mod watch_inbox;
pub mod withdrawn;
