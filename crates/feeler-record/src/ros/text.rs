//! `std_msgs/String`.

use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// A text message.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Text {
    /// The text.
    pub data: String,
    /// Recorded time (s). Not part of the message.
    #[serde(skip)]
    pub stamp: f64,
}

impl Message for Text {
    const SCHEMA_NAME: &'static str = "std_msgs/msg/String";
    const SCHEMA: &'static str = "string data\n";
}
