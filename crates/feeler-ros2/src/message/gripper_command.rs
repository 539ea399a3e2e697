//! Goals of the action `control_msgs/ParallelGripperCommand`. Sending a goal is a service of the action.

use feeler_record::ros::{JointState, Time};
use serde::{Deserialize, Serialize};

/// Request of [`SendGripperGoal`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SendGripperGoalRequest {
    /// Unique identifier of the goal.
    pub goal_id: [u8; 16],
    /// Name, goal position (m or rad) and, optionally, maximum velocity and effort of the gripper's joint.
    pub command: JointState,
}

/// Response of [`SendGripperGoal`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SendGripperGoalResponse {
    /// `true` if the server accepted the goal.
    pub accepted: bool,
    /// Time of the decision.
    pub stamp: Time,
}

ros_service!(
    /// Service by which an action server accepts goals: `_action/send_goal` below the action's name.
    SendGripperGoal = "control_msgs/action/ParallelGripperCommand_SendGoal",
    SendGripperGoalRequest: "unique_identifier_msgs/UUID goal_id\ncontrol_msgs/action/ParallelGripperCommand_Goal goal\n",
        "unique_identifier_msgs/UUID",
        "control_msgs/action/ParallelGripperCommand_Goal",
        "sensor_msgs/JointState",
        "std_msgs/Header",
        "builtin_interfaces/Time";
    SendGripperGoalResponse: "bool accepted\nbuiltin_interfaces/Time stamp\n",
        "builtin_interfaces/Time"
);
