#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[cfg_attr(target_os = "linux", path = "list/linux.rs")]
#[cfg_attr(not(target_os = "linux"), path = "list/elsewhere.rs")]
mod list;
#[cfg_attr(target_os = "linux", path = "port/linux.rs")]
#[cfg_attr(not(target_os = "linux"), path = "port/elsewhere.rs")]
mod port;
#[cfg(target_os = "linux")]
mod terminal;

pub use list::list_ports;
pub use port::SerialPort;
#[cfg(target_os = "linux")]
pub use terminal::PseudoTerminal;

/// A serial port of this computer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedPort {
    /// Path, such as `/dev/ttyACM0` or `COM3`.
    pub path: String,
    /// Name of the USB device, empty if unknown.
    pub product: String,
}
