//! Sensors, hand and world as programs of their own.

#![cfg(all(feature = "link", unix))]

#[path = "../support/program.rs"]
mod program;

mod cable;
mod faults;
mod hostile;
mod orders;
mod rig;
mod soak;
mod together;
