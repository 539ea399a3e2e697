//! Tests of this crate, linked into a single program.

mod digest;
mod mcap_tools;
#[path = "../support/python.rs"]
mod python;
mod recorded_camera;
mod recording;
#[path = "../../../feeler-lab/tests/support/skip.rs"]
mod skip;
#[path = "../support/mod.rs"]
mod support;
mod urdf;
