//! Faults: each changes what it should, when it should, and nothing else.

mod bench;
#[path = "../support/program.rs"]
mod program;
mod refused;
mod rig;
mod sensor;
