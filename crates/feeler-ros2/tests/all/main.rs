//! All tests of this crate in one binary, which links once and runs in parallel.
//!
//! Their allocator aborts the process if a control period allocates.

mod cloud;
mod hostile;
mod robot;
mod tokens;
mod type_hashes;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
