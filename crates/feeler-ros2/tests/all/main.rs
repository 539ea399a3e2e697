//! The tests of this crate: linked once, and all at once over the processors.
//!
//! They run under an allocator that ends the process when a control period allocates.

mod cloud;
mod hostile;
mod robot;
mod tokens;
mod type_hashes;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
