//! The hand program: from forces to flags, from flags to fingertip velocities, to joint velocities.

mod config;
pub mod control_loop;
pub mod controller;
pub mod feeler_shape;
pub mod flags;
pub mod law;
pub mod limits;
pub mod phase;
pub mod plan;
pub mod sense;
pub mod slip_detector;
pub mod stop_reason;
pub mod task;
pub mod touch;
