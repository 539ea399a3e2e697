//! Six-axis force/torque sensors that stream over Ethernet with the protocol of ATI's Net F/T, Raw Data Transfer (RDT) over UDP.
//!
//! ATI Industrial Automation, *Net F/T Installation and Operation Manual*, section "UDP Interface Using RDT".

mod address;
mod client;
mod counts;
mod emulator;
mod rdt;

pub use address::{AddressError, Counts, NetFtAddress};
pub use client::{ForceError, ForceSample, NetFt};
pub use counts::{CountsError, parse_counts, read_counts};
pub use emulator::NetFtEmulator;
pub use rdt::{Command, RDT_PORT, RdtError, Record, Request};
