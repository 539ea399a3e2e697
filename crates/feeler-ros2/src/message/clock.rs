//! `rosgraph_msgs/Clock`.

use feeler_record::ros::Time;
use serde::{Deserialize, Serialize};

/// The time of a simulation or a replay.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// That time.
    pub clock: Time,
}

ros_message!(
    Clock,
    "rosgraph_msgs/msg/Clock",
    include_str!("../../msg/rosgraph_msgs/Clock.msg"),
    "builtin_interfaces/Time",
);
