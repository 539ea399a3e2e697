//! All tests of this crate that can share a process, linked once and run in parallel.
//!
//! They run under an allocator that ends the process when the control path allocates.

mod architecture;
mod calibration;
mod control;
mod control_contract;
mod hand_kinematics;
mod one_door;
mod own_hand;
mod pace;
mod pictures;
mod resultant;
mod sensor;
mod tasks;
mod track;
mod wrench;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
