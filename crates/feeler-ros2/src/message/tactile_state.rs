//! `feeler_msgs/TactileState`, installed by the package `ros2/feeler_msgs`.

use feeler_record::ros::Header;
use feeler_record::wire::Vector3;
use serde::{Deserialize, Serialize};

/// Tactile state of one fingertip.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileState {
    /// Time of the image that the forces were computed from, and the dome's frame.
    pub header: Header,
    /// Sequence number of the image.
    pub sequence: u64,
    /// TOUCH: an element's F_z is above F1, or SLIP.
    pub touch: bool,
    /// SLIP: an element's shear rate is above dr.
    pub slip: bool,
    /// OVER: an element's F_z is above F2.
    pub over: bool,
    /// Touching element with the largest F_z, or [`NO_ELEMENT`](feeler_record::NO_ELEMENT).
    pub largest_element: u32,
    /// Grasp force: sum of the positive F_z (N).
    pub grasp_force: f64,
    /// Force on each element in its frame `E_i` (N), or NaN if unknown. x and y are the tangential force on the feeler
    /// by the object; z is the compression, positive when pressed.
    pub forces: Vec<Vector3>,
    /// Shear rate |d(F_x, F_y)/dt| of each element (N/s).
    pub shear_rate: Vec<f64>,
    /// `true` for each element that slips.
    pub slips: Vec<bool>,
}

ros_message!(
    TactileState,
    "feeler_msgs/msg/TactileState",
    include_str!("../../msg/feeler_msgs/TactileState.msg"),
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/Vector3",
);
