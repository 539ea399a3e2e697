//! The control path does not allocate, over whole runs.
//!
//! Every test of this program runs under an allocator that ends the process when the control path
//! allocates.

use assert_no_alloc::AllocDisabler;

mod allocation;
#[path = "../../../feeler/tests/control_contract/hand.rs"]
mod hand;
mod physics;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
