//! The live page: who is let in, what comes over its socket, what its orders do, and that a run does not notice it.

// Programs are ended by signals.
#![cfg(unix)]

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
