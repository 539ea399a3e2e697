//! `std_srvs/Trigger`.

use crate::type_description::Service;
use serde::{Deserialize, Serialize};

/// The service that does one thing.
#[derive(Debug, Clone, Copy)]
pub enum Trigger {}

/// Asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// Without meaning: what has no field has this one.
    pub structure_needs_at_least_one_member: u8,
}

/// What came of it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// Whether it was done.
    pub success: bool,
    /// What there is to be said.
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
