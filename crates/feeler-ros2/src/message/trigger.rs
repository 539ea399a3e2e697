//! `std_srvs/Trigger`.

use crate::type_description::Service;
use serde::{Deserialize, Serialize};

/// Service that triggers an action without arguments.
#[derive(Debug, Clone, Copy)]
pub enum Trigger {}

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

impl Service for Trigger {
    const NAME: &'static str = "std_srvs/srv/Trigger";
    type Request = TriggerRequest;
    type Response = TriggerResponse;
}

ros_message!(TriggerRequest, "std_srvs/srv/Trigger_Request", "");
ros_message!(
    TriggerResponse,
    "std_srvs/srv/Trigger_Response",
    "bool success\nstring message\n"
);
