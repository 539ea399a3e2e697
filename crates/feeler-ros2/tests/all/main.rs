//! All tests of this crate in one binary, which links once and runs in parallel.
//!
//! Their allocator aborts the process if a control period allocates.

mod cloud;
mod gripper;
mod hostile;
#[cfg(feature = "zenoh")]
#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;
mod robot;
mod tokens;
mod type_hashes;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
