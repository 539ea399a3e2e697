//! Tactile skins on serial ports: live sensors, emulators, and the search for connected skins.
//!
//! [`SkinSensor`] is a tactile sensor. `SkinEmulator` (Linux) provides a skin on a pseudo-terminal to any program.
//! The protocols are those of [`feeler::sensor::skin`].

mod connection;
mod counters;
mod error;
mod event;
mod probe;
mod sensor;

#[cfg(target_os = "linux")]
mod emulator;
#[cfg(target_os = "linux")]
mod simulated;

pub use counters::SkinCounters;
#[cfg(target_os = "linux")]
pub use emulator::SkinEmulator;
pub use error::SkinError;
pub use event::SkinEvent;
pub use feeler_serial::{ListedPort, list_ports};
pub use probe::{FoundSkin, probe_port};
pub use sensor::{SkinNews, SkinSensor};
