//! Six-axis force/torque sensors that stream over Ethernet as ATI's Net F/T does: Raw Data Transfer (RDT) over UDP.
//!
//! ATI Industrial Automation, *Net F/T Installation and Operation Manual*, section "UDP Interface Using RDT".

mod address;
mod client;
mod emulator;
mod rdt;

pub use address::{AddressError, NetFtAddress};
pub use client::{ForceError, ForceSample, NetFt};
pub use emulator::NetFtEmulator;
pub use rdt::{Command, RDT_PORT, RdtError, Record, Request};
