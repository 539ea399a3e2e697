//! Tests of this crate, linked into a single program.
//!
//! They run with an allocator that aborts if a control period allocates.

mod allocation;
mod any_joints;
mod faults;
mod hand;
mod hostile_master;
mod modes;
mod packets;
mod positions;
mod scs;
mod shared;
#[cfg(target_os = "linux")]
#[path = "../support/mod.rs"]
mod support;
mod terminal;
mod timing;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
