//! The hand program: from forces to flags, from flags to fingertip velocities, to joint velocities.

pub mod control_loop;
pub mod controller;
pub mod flags;
pub mod limits;
pub mod speed;
pub mod task;
