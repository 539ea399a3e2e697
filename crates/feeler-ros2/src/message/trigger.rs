//! `std_srvs/Trigger`.

use crate::type_description::Service;
use serde::{Deserialize, Serialize};

/// Service that triggers an action without arguments.
#[derive(Debug, Clone, Copy)]
pub enum Trigger {}

/// Request of [`Trigger`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// Placeholder: messages without fields have this one.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`Trigger`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// `true` if the action was done.
    pub success: bool,
    /// Details for a person.
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
