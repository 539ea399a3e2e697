//! The controller: from forces to flags, fingertip velocities and joint velocities.

pub(crate) mod config;
pub(crate) mod control_loop;
pub(crate) mod controller;
pub(crate) mod feeler_shape;
pub(crate) mod flags;
pub(crate) mod frozen_forces;
pub mod grasp_slip;
pub(crate) mod input_check;
pub(crate) mod joint_monitor;
pub mod law;
pub(crate) mod limits;
pub mod live_touch;
pub(crate) mod monitor;
pub(crate) mod monitor_config;
pub(crate) mod observation;
pub(crate) mod phase;
pub mod plan;
pub mod sense;
pub(crate) mod slip_detector;
pub(crate) mod stop_reason;
pub mod task;
pub(crate) mod touch;

pub use control_loop::{ControlError, ControlLoop, Supervisor};
pub use controller::{ControlConfig, Controller, FingerControl, RecordingFailure, ResumePolicy};
pub use feeler_shape::{FeelerShape, Stiffness};
pub use flags::{FingerFlags, FlagAnalyzer, FlagThresholds};
pub use limits::{Admitted, LimitsConfig, Request};
pub use live_touch::{LiveArrivals, LiveTouch, live};
pub use monitor_config::MonitorConfig;
pub use observation::{ObservationError, ObservationLayout, ObservationPart};
pub use phase::Phase;
pub use plan::Plan;
pub use sense::{FingerSense, FingertipPose, HandSense};
pub use slip_detector::SlipDetector;
pub use stop_reason::StopReason;
pub use touch::{AnalyzedSensor, FingerTouch, TouchSource};
