//! Sensors, hand and world as programs of their own.

#![cfg(all(feature = "link", unix))]

#[path = "../support/program.rs"]
mod program;

#[cfg(all(feature = "top", target_os = "linux"))]
#[path = "../support/terminal.rs"]
mod in_terminal;

mod faults;
mod orders;
mod rig;
mod together;
#[cfg(all(feature = "top", target_os = "linux"))]
mod watched;
