#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[cfg(feature = "drives")]
mod drives_check;
mod hand_record;
mod latency_bench;
mod link_options;
mod real_time;
#[cfg(feature = "ros2")]
mod ros2;
mod run_outcome;
#[cfg(all(feature = "drives", target_os = "linux"))]
mod served_drives;
mod session;
mod stop;
mod wrench_topic;

#[cfg(feature = "drives")]
pub use drives_check::{ServoRig, all_changes, check_servos, display_unit, print_changes};
pub use hand_record::{FinishedRecord, HandRecord, patience};
pub use latency_bench::{LatencyBench, measure_latency, send_readings};
pub use link_options::{LinkOptions, ListenOptions};
pub use real_time::request_real_time;
#[cfg(feature = "ros2")]
pub use ros2::{GraphOptions, publish_recording, publish_rig, serve_robot};
pub use run_outcome::{make_report, print_outcome};
#[cfg(all(feature = "drives", target_os = "linux"))]
pub use served_drives::{DrivesOptions, serve_drives};
pub use session::RigSession;
pub use stop::{call_stop_server, open_stop_server};
pub use wrench_topic::WrenchAddress;
#[cfg(feature = "ros2")]
pub use wrench_topic::{WrenchError, WrenchTopic};
