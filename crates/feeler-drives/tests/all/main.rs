//! The tests of this crate: linked once, and all at once over the processors.
//!
//! They run under an allocator that ends the process when a control period allocates.

mod allocation;
mod hand;
mod packets;
#[cfg(target_os = "linux")]
#[path = "../support/mod.rs"]
mod support;
mod terminal;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
