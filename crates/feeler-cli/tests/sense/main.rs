//! `feeler sense`, through the program: forces from pictures of known loads, and bad input.

mod bad_input;
mod decoding;
mod forces;
#[cfg(unix)]
mod interrupted;
#[path = "../support/program.rs"]
mod program;
mod rendered;
mod table;
