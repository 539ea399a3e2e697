//! `diagnostic_msgs/DiagnosticArray`.

use feeler_record::ros::Header;
use serde::{Deserialize, Serialize};

/// Diagnostics of all parts of a system.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// Time of the diagnostics.
    pub header: Header,
    /// Status of each part.
    pub status: Vec<DiagnosticStatus>,
}

/// Status of one part.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// Severity, a [`DiagnosticLevel`].
    pub level: u8,
    /// Name of the part.
    pub name: String,
    /// Description of the status.
    pub message: String,
    /// Identifier of the hardware.
    pub hardware_id: String,
    /// Measured values and other details.
    pub values: Vec<KeyValue>,
}

/// Severity of a status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum DiagnosticLevel {
    /// No problem.
    Ok = 0,
    /// The part works, but requires attention.
    Warn = 1,
    /// The part does not work.
    Error = 2,
    /// No recent data.
    Stale = 3,
}

/// Name and value of a detail.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// Name.
    pub key: String,
    /// Value.
    pub value: String,
}

ros_message!(
    DiagnosticArray,
    "diagnostic_msgs/msg/DiagnosticArray",
    include_str!("../../msg/diagnostic_msgs/DiagnosticArray.msg"),
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "diagnostic_msgs/DiagnosticStatus",
    "diagnostic_msgs/KeyValue",
);
