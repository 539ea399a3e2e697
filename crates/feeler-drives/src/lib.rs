#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[cfg(target_os = "linux")]
pub mod bus;
pub(crate) mod clock;
pub mod config;
#[cfg(target_os = "linux")]
pub mod emulator;
#[cfg(target_os = "linux")]
pub(crate) mod error;
#[cfg(target_os = "linux")]
pub mod hand;
#[cfg(target_os = "linux")]
pub(crate) mod health;
pub mod packet;
#[cfg(target_os = "linux")]
pub(crate) mod port;
pub mod registers;
#[cfg(target_os = "linux")]
pub(crate) mod serial;
#[cfg(target_os = "linux")]
pub(crate) mod servo;
#[cfg(target_os = "linux")]
pub mod setup;

pub use clock::RigClock;
#[cfg(target_os = "linux")]
pub use error::{DriveError, JointName};
#[cfg(target_os = "linux")]
pub use port::Port;
