//! Integration tests of this crate, linked as one program, except those that require a separate process.
//!
//! They run under an allocator that aborts the process if the control path allocates.

mod control_contract;
mod environment;
mod grip_on_bus;
mod needed_grip;
mod own_task;
mod record;
mod runs;
mod sim_physics;
#[path = "../support/skip.rs"]
mod skip;
mod slip_on_a_cap;
#[path = "../../../feeler-record/tests/support/mod.rs"]
mod support;
mod sweep;
#[path = "../support/runs.rs"]
mod whole_runs;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
