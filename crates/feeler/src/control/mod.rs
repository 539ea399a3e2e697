//! The controller: from forces to flags, fingertip velocities and joint velocities.

mod config;
pub mod control_loop;
pub mod controller;
pub mod feeler_shape;
pub mod flags;
mod frozen_forces;
pub mod grasp_slip;
mod input_check;
mod joint_monitor;
pub mod law;
pub mod limits;
pub mod live_touch;
mod monitor;
pub mod monitor_config;
pub mod observation;
pub mod phase;
pub mod plan;
pub mod sense;
pub mod slip_detector;
pub mod stop_reason;
pub mod task;
pub mod touch;
