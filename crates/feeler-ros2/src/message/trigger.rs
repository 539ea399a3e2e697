//! `std_srvs/Trigger`.

use serde::{Deserialize, Serialize};

/// Request of [`Trigger`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// Placeholder that ROS 2 adds to messages without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`Trigger`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// `true` if the action succeeded.
    pub success: bool,
    /// Human-readable details.
    pub message: String,
}

ros_service!(
    /// Service that triggers an action without arguments.
    Trigger = "std_srvs/srv/Trigger",
    TriggerRequest: "";
    TriggerResponse: "bool success\nstring message\n"
);
