//! Plausibility checks of joint and tactile sensors while the hand moves. A contradiction stops the hand.

mod config;
mod effort;
mod joints;
mod stuck_sensor;

pub use config::MonitorConfig;
pub(super) use effort::{EffortMonitor, ExpectedEfforts};
pub(super) use joints::JointMonitor;
pub(super) use stuck_sensor::StuckSensorDetector;
