//! Properties of control: definitions, limits, and freedom from allocation and panics.

mod config;
mod follow;
mod grasp_slip;
mod hand;
mod hostile;
mod laws;
mod live;
mod loop_faults;
mod missing_shear;
mod policy;
#[path = "../../support/policy_file.rs"]
mod policy_file;
mod policy_file_errors;
mod rig;
mod speed;
mod task;
