//! `sensor_msgs/JointState`.

use super::header::{Header, header_schema};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// States of all joints of a hand.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// Time of the reading.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Joint angles (rad).
    pub position: Vec<f64>,
    /// Joint velocities (rad/s).
    pub velocity: Vec<f64>,
    /// Joint torques (N m). Empty, because they are not known.
    pub effort: Vec<f64>,
}

impl Message for JointState {
    const SCHEMA_NAME: &'static str = "sensor_msgs/msg/JointState";
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\n",
        "string[] name\n",
        "float64[] position\n",
        "float64[] velocity\n",
        "float64[] effort\n",
        header_schema!(),
    );
}
