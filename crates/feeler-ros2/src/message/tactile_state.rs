//! `feeler_msgs/TactileState`, which the package `ros2/feeler_msgs` installs.

use feeler_record::ros::Header;
use feeler_record::wire::Vector3;
use serde::{Deserialize, Serialize};

/// What one fingertip feels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileState {
    /// Time of the picture that the forces come from; the frame of the dome.
    pub header: Header,
    /// Sequence number of that picture.
    pub sequence: u64,
    /// TOUCH: an element is pressed harder than F1, or SLIP.
    pub touch: bool,
    /// SLIP: an element's shear rate exceeds dr.
    pub slip: bool,
    /// OVER: an element is pressed harder than F2.
    pub over: bool,
    /// The touching element of largest F_z, or [`NO_ELEMENT`](feeler_record::NO_ELEMENT).
    pub largest_element: u32,
    /// Sum of the positive F_z, N.
    pub grasp_force: f64,
    /// Force at each element in its frame `E_i`, N: x, y tangential on the feeler by the object, z compression, positive when pressed;
    /// not a number where it is not known.
    pub forces: Vec<Vector3>,
    /// |d(F_x, F_y)/dt| of each element, N/s.
    pub shear_rate: Vec<f64>,
    /// Whether each element slips.
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
