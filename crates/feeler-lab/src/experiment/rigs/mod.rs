//! Rigs of several programs: simulated, on a servo bus, or over the link.

#[cfg(target_os = "linux")]
pub(crate) mod bus_rig;
#[cfg(target_os = "linux")]
pub mod driven;
pub mod linked;
pub(crate) mod sim_rig_server;
