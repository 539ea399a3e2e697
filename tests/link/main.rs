//! A rig of several programs: the same as in one where nothing goes wrong, and still where something does.
//!
//! Everything here runs the programs as a user does. What is held against the promises is what the hand
//! recorded, by the rig's own time; no test measures the wall clock.

#![cfg(all(feature = "link", unix))]

#[cfg(target_os = "linux")]
mod cable;
mod faults;
mod mismatch;
mod orders;
mod process;
#[path = "../support/program.rs"]
mod program;
mod promises;
mod rig;
mod strangers;
mod undisturbed;
