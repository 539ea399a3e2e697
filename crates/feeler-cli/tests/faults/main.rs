//! Faults: each changes what it should, when it should, and nothing else.
//!
//! The tests run under an allocator that ends the process when the control path allocates.

use assert_no_alloc::AllocDisabler;

mod bench;
#[path = "../support/program.rs"]
mod program;
mod refused;
mod rig;
mod same_stop;
mod sensor;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
