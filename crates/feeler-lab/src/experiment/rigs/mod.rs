//! Rigs whose parts run in several programs: simulated, on a servo bus, or connected by the link.

#[cfg(target_os = "linux")]
pub(crate) mod bus_rig;
#[cfg(target_os = "linux")]
pub mod driven;
pub mod linked;
pub(crate) mod sim_rig_server;
#[cfg(target_os = "linux")]
mod world_plant;
