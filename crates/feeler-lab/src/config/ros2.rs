//! The table `[ros2]` of an experiment file, which uses a robot of a ROS 2 graph as the hand and its sensors as
//! fingertips.

use feeler::check::Checker;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Maximum length of the name of a topic or joint.
const MAX_NAME: usize = 255;

/// Robot whose joints are the joints of the hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RosConfig {
    /// Topic of the joint states (`sensor_msgs/JointState`).
    #[serde(default = "joint_states")]
    pub joint_states: String,
    /// Topic of velocity commands (`std_msgs/Float64MultiArray`, rad/s or m/s) for a `forward_command_controller` whose
    /// joints are in the order of this table.
    #[serde(default = "commands")]
    pub commands: String,
    /// Gripper whose action moves all fingers, in place of `commands`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gripper: Option<RosGripperConfig>,
    /// The fingers, in the order of `hand.finger`.
    pub finger: Vec<RosFingerConfig>,
}

/// Gripper with one motor, driven by its action `control_msgs/ParallelGripperCommand`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RosGripperConfig {
    /// Name of the action.
    #[serde(default = "action")]
    pub action: String,
    /// Maximum effort of the joint (N, or N m for a revolute joint), sent with each goal. `None` for the controller's
    /// own limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_effort: Option<f64>,
    /// Minimum interval between two goals (s of real time).
    #[serde(default = "interval")]
    pub interval: f64,
}

/// Joints of one finger, and the topic of its tactile sensor, if any.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RosFingerConfig {
    /// Names of the joints, from the base to the fingertip.
    pub joints: Vec<String>,
    /// Topic of a `sensor_msgs/PointCloud2` with one point per element of the fingertip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cloud: Option<String>,
    /// Topic of a `geometry_msgs/WrenchStamped`, for a fingertip with one element.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrench: Option<String>,
}

fn joint_states() -> String {
    "/joint_states".into()
}

fn commands() -> String {
    "/forward_velocity_controller/commands".into()
}

fn action() -> String {
    "/gripper_controller/gripper_cmd".into()
}

fn interval() -> f64 {
    0.02
}

impl RosGripperConfig {
    fn check(&self, key: &str, fingers: &[(usize, usize)], checker: &mut Checker) {
        name(&format!("{key}.action"), &self.action, checker);
        checker.between(&format!("{key}.interval"), self.interval, 0.001, 1.0);
        if let Some(effort) = self.max_effort {
            checker.between(&format!("{key}.max_effort"), effort, 1e-3, 1e4);
        }
        for (number, &(_, joints)) in fingers.iter().enumerate() {
            checker.require(
                key,
                format!("a gripper for {joints} joints of finger {number}"),
                joints == 1,
                "one joint per finger, all moved by the joint of the first one",
            );
        }
    }
}

impl RosConfig {
    /// Requires every value of the table `key` to be in range. `fingers` are the numbers of elements and joints of each
    /// finger.
    pub fn check(&self, key: &str, fingers: &[(usize, usize)], checker: &mut Checker) {
        name(&format!("{key}.joint_states"), &self.joint_states, checker);
        name(&format!("{key}.commands"), &self.commands, checker);
        if let Some(gripper) = &self.gripper {
            gripper.check(&format!("{key}.gripper"), fingers, checker);
        }
        let (actual, expected) = (self.finger.len(), fingers.len());
        checker.require(
            &format!("{key}.finger"),
            format!("{actual} fingers"),
            actual == expected,
            &format!("as many fingers as hand.finger ({expected})"),
        );
        let mut names = BTreeSet::new();
        for (number, (finger, &(elements, joints))) in self.finger.iter().zip(fingers).enumerate() {
            let key = format!("{key}.finger[{number}]");
            let actual = finger.joints.len();
            checker.require(
                &format!("{key}.joints"),
                format!("{actual} names"),
                actual == joints,
                &format!("as many names as joints of hand.finger[{number}] ({joints})"),
            );
            for joint in &finger.joints {
                let field = format!("{key}.joints");
                name(&field, joint, checker);
                let value = format!("{joint:?}");
                checker.require(
                    &field,
                    value,
                    names.insert(joint) || self.gripper.is_some(),
                    "a different name for each joint, unless a gripper has one for all",
                );
            }
            finger.check_sensor(&key, elements, checker);
        }
    }
}

impl RosFingerConfig {
    fn check_sensor(&self, key: &str, elements: usize, checker: &mut Checker) {
        if let Some(cloud) = &self.cloud {
            name(&format!("{key}.cloud"), cloud, checker);
        }
        if let Some(wrench) = &self.wrench {
            let field = format!("{key}.wrench");
            name(&field, wrench, checker);
            checker.require(
                &field,
                format!("{wrench:?}"),
                self.cloud.is_none(),
                "a wrench or a cloud, not both",
            );
            let expected = format!(
                "a fingertip of one element; this one has {elements}, which requires a cloud"
            );
            checker.require(&field, format!("{wrench:?}"), elements == 1, &expected);
        }
    }
}

/// Requires a valid name of a topic or joint.
fn name(field: &str, value: &str, checker: &mut Checker) {
    let good = (1..=MAX_NAME).contains(&value.len()) && !value.chars().any(char::is_whitespace);
    let expected = format!("1 to {MAX_NAME} characters without a space");
    checker.require(field, format!("{value:?}"), good, &expected);
}
