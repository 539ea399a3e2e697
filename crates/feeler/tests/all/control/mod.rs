//! Control with synthetic input: checks, flags, limits and tasks.

mod contour;
mod efforts;
mod faulty_input;
mod flags;
mod frozen_forces;
mod joint_faults;
mod limits;
mod rig;
mod stopped;
