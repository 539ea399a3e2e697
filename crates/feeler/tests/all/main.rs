//! Integration tests of this crate, linked as one program, except those that require a separate process.
//!
//! They run under an allocator that aborts the process if the control path allocates.
#![allow(
    clippy::disallowed_methods,
    reason = "test inputs need not be bit-identical across platforms"
)]

mod architecture;
mod calibration;
mod chain;
mod control;
mod control_contract;
mod hand_kinematics;
mod joint_vector;
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
