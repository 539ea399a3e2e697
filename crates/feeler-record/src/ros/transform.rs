//! `tf2_msgs/TFMessage`.

use super::header::{Header, header_schema, nested, quaternion_schema, xyz_schema};
use crate::wire::{Message, Quaternion, Vector3};
use glam::{DAffine3, DQuat};
use serde::{Deserialize, Serialize};

/// Pose of a frame in its parent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Origin (m).
    pub translation: Vector3,
    /// Rotation.
    pub rotation: Quaternion,
}

impl From<DAffine3> for Transform {
    fn from(pose: DAffine3) -> Self {
        Self {
            translation: pose.translation.into(),
            rotation: DQuat::from_mat3(&pose.matrix3).into(),
        }
    }
}

/// Pose of a frame in its parent at a time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Time and parent frame.
    pub header: Header,
    /// Name of the child frame.
    pub child_frame_id: String,
    /// Pose of the child in its parent.
    pub transform: Transform,
}

/// A list of transforms.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// The transforms, one per frame.
    pub transforms: Vec<TransformStamped>,
}

impl Message for TFMessage {
    const SCHEMA_NAME: &'static str = "tf2_msgs/msg/TFMessage";
    const SCHEMA: &'static str = concat!(
        "geometry_msgs/TransformStamped[] transforms\n",
        nested!(
            "geometry_msgs/TransformStamped",
            "std_msgs/Header header",
            "string child_frame_id",
            "Transform transform",
        ),
        header_schema!(),
        nested!(
            "geometry_msgs/Transform",
            "Vector3 translation",
            "Quaternion rotation",
        ),
        xyz_schema!("geometry_msgs/Vector3"),
        quaternion_schema!(),
    );
}
