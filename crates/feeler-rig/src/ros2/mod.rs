//! A rig, a recording or a robot in a ROS 2 graph over Zenoh.

mod diagnostics;
mod fingertip;
mod graph;
mod joints;
mod orders;
mod recording;
mod rig;
mod robot;
mod stamps;

pub use graph::{GraphOptions, domain_of_environment};
pub use recording::publish_recording;
pub use rig::publish_rig;
pub use robot::serve_robot;
