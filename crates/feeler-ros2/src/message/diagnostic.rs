//! `diagnostic_msgs/DiagnosticArray`.

use feeler_record::ros::Header;
use serde::{Deserialize, Serialize};

/// How all parts of a system are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When that was so.
    pub header: Header,
    /// One for each part.
    pub status: Vec<DiagnosticStatus>,
}

/// How a part is.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// How bad it is: a [`DiagnosticLevel`].
    pub level: u8,
    /// Which part it is.
    pub name: String,
    /// What there is to be said.
    pub message: String,
    /// Which device it is.
    pub hardware_id: String,
    /// What is known of it.
    pub values: Vec<KeyValue>,
}

/// How bad something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum DiagnosticLevel {
    /// All is well.
    Ok = 0,
    /// It works, and somebody should look.
    Warn = 1,
    /// It does not work.
    Error = 2,
    /// Nothing is heard of it.
    Stale = 3,
}

/// Something that is known.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What it is called.
    pub key: String,
    /// What it is.
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
