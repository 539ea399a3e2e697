//! The controller: from forces to flags, fingertip velocities and joint velocities.

pub mod background_sensor;
pub(crate) mod config;
pub(crate) mod control_loop;
pub(crate) mod controller;
pub(crate) mod feeler_shape;
pub(crate) mod flags;
pub mod grasp_slip;
pub(crate) mod input_check;
pub(crate) mod joint_monitor;
pub mod law;
pub(crate) mod limits;
pub(crate) mod monitor;
pub(crate) mod monitor_config;
pub(crate) mod observation;
pub(crate) mod phase;
pub mod plan;
pub mod sense;
pub(crate) mod slip_detector;
pub(crate) mod stop_reason;
pub(crate) mod stuck_sensor;
pub mod task;
pub(crate) mod touch;

pub use background_sensor::{BackgroundSensor, NewDataSignal, live};
pub use control_loop::{ControlError, ControlLoop, Supervisor};
pub use controller::{ControlConfig, Controller, FingerControl, RecordingFailure, ResumePolicy};
pub use feeler_shape::{FeelerShape, Stiffness};
pub use flags::{FingerFlags, FlagAnalyzer, FlagThresholds};
pub use limits::{LimitedCommand, LimitsConfig, Request};
pub use monitor_config::MonitorConfig;
pub use observation::{ObservationError, ObservationLayout, ObservationPart};
pub use phase::Phase;
pub use plan::Plan;
pub use sense::{FingerReadings, FingertipPose, HandReadings};
pub use slip_detector::SlipDetector;
pub use stop_reason::StopReason;
pub use touch::{FlaggedSensor, TactileReading, TactileSource};
