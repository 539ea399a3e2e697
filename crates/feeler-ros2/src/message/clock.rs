//! `rosgraph_msgs/Clock`.

use feeler_record::ros::Time;
use serde::{Deserialize, Serialize};

/// Time of a simulation or replay.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// Current time.
    pub clock: Time,
}

ros_message!(
    Clock,
    "rosgraph_msgs/msg/Clock",
    include_str!("../../msg/rosgraph_msgs/Clock.msg"),
    "builtin_interfaces/Time",
);
