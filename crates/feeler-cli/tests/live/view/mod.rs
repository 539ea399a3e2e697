//! The live page: access control, rows over its socket, its orders, and that it does not affect the run.

// Programs are ended with signals.
#![cfg(unix)]

mod bad_input;
mod end;
mod felt;
mod let_in;
mod orders;
mod recording;
mod rows;
mod slow;
mod viewed;
#[cfg(feature = "link")]
mod watched;
