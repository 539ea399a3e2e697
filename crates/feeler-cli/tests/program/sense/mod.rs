//! `feeler sense`: forces from images of known loads, and invalid input.

mod assumed;
mod bad_input;
mod contact;
mod decoding;
mod forces;
#[cfg(unix)]
pub mod interrupted;
mod recorded_pictures;
mod rendered;
mod table;
mod taxel_recordings;
mod taxels;
mod track;
