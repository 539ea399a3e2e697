#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[cfg(target_os = "linux")]
pub mod bus;
pub mod clock;
pub mod config;
#[cfg(target_os = "linux")]
pub mod emulator;
#[cfg(target_os = "linux")]
pub mod error;
#[cfg(target_os = "linux")]
pub mod hand;
#[cfg(target_os = "linux")]
pub mod health;
pub mod packet;
#[cfg(target_os = "linux")]
pub mod port;
pub mod registers;
#[cfg(target_os = "linux")]
pub mod serial;
#[cfg(target_os = "linux")]
mod servo;
#[cfg(target_os = "linux")]
pub mod setup;
