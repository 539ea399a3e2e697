//! Networks that carry messages: Zenoh, endpoints, topics, simulated impairments.

pub(crate) mod endpoints;
#[cfg(feature = "zenoh")]
pub(crate) mod linger;
pub(crate) mod network;
pub(crate) mod outlet;
pub(crate) mod shared;
pub(crate) mod topic;
#[cfg(feature = "zenoh")]
pub(crate) mod zenoh_link;
#[cfg(feature = "zenoh")]
pub(crate) mod zenoh_settings;

pub use endpoints::{HAND_ENDPOINT, LinkConfig, LinkError};
pub use network::{ImpairedNetwork, Impairment, MessageHandler, Network};
pub use outlet::{Outlet, TimeSource, draw_instance, encode, header, monotonic, send};
pub use shared::Shared;
pub use topic::{ProgramRole, Topic};
#[cfg(feature = "zenoh")]
pub use zenoh_link::Link;
