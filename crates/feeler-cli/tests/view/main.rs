//! The live page: who is let in, what comes over its socket, what its orders do, and that a run does not notice it.

// Programs are ended by signals.
#![cfg(unix)]

#[path = "../support/program.rs"]
mod program;

#[cfg(feature = "link")]
#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;

#[cfg(feature = "link")]
#[path = "../link/rig.rs"]
mod rig;

mod bad_input;
mod end;
mod let_in;
mod orders;
mod recording;
mod rows;
mod slow;
mod viewed;
#[cfg(feature = "link")]
mod watched;
