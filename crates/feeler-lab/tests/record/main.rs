//! Recordings: written, read, by other tools, too, reported and replayed.

mod claims;
mod figures;
mod mcap_tools;
mod recorded_camera;
mod recording;
mod replay;
mod report;
#[path = "../support/mod.rs"]
mod support;
