//! `feeler sense`, through the program: forces from pictures of known loads, and bad input.

mod assumed;
mod bad_input;
mod decoding;
mod forces;
#[cfg(unix)]
mod interrupted;
mod recorded_pictures;
mod rendered;
mod table;
mod taxel_recordings;
mod taxels;
mod track;
