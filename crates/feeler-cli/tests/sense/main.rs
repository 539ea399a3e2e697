//! `feeler sense`, through the program: forces from pictures of known loads, and bad input.

mod assumed;
mod bad_input;
mod decoding;
mod forces;
#[cfg(unix)]
mod interrupted;
#[path = "../support/program.rs"]
mod program;
mod recorded_pictures;
#[path = "../../../feeler-lab/tests/support/recordings.rs"]
mod recordings;
mod rendered;
mod table;
mod taxel_recordings;
mod taxels;
mod track;
