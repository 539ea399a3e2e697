//! `feeler ros2` and the crate `feeler-ros2` with independent peers.
//!
//! Requires `pip install pyzeros==0.1.0` in the Python named by `FEELER_PYTHON` (default `python3`), and `pip install
//! ros-jazzy-rclpy==7.1.6` with its message packages in the one named by `FEELER_ROS_PYTHON` (3.12). Without them the
//! tests report that they are skipped, or fail if `FEELER_REQUIRE_ALL` is set.

mod client;
mod gripper;
mod node;
mod options;
mod peers;
mod restarts;
mod rig;
mod robot_rig;
mod sensor;
mod values;
