//! `sensor_msgs/JointState`.

use super::header::{Header, header_schema};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// All joints of a hand.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When they were read.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Their angles, rad.
    pub position: Vec<f64>,
    /// Their velocities, rad/s.
    pub velocity: Vec<f64>,
    /// Their torques, N m; empty, as they are not known.
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
