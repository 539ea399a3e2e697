//! The [`Message`] trait, and types shared by several messages.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// A plain struct with its ROS 2 message text. The fields are in the order of the text's lines; both define the wire
/// format.
pub trait Message: Serialize + DeserializeOwned {
    /// ROS 2 name of the message type.
    const SCHEMA_NAME: &'static str;
    /// ROS 2 message text, followed by the text of every nested type.
    const SCHEMA: &'static str;
}

/// A vector, as ROS 2's `geometry_msgs/Vector3`. Unit and frame are documented at the field.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Component along x.
    pub x: f64,
    /// Component along y.
    pub y: f64,
    /// Component along z.
    pub z: f64,
}

impl From<DVec3> for Vector3 {
    fn from(v: DVec3) -> Self {
        let DVec3 { x, y, z } = v;
        Self { x, y, z }
    }
}

impl From<Vector3> for DVec3 {
    fn from(v: Vector3) -> Self {
        DVec3::new(v.x, v.y, v.z)
    }
}

/// A rotation, as ROS 2's `geometry_msgs/Quaternion`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// x component of the quaternion.
    pub x: f64,
    /// y component of the quaternion.
    pub y: f64,
    /// z component of the quaternion.
    pub z: f64,
    /// w component (real part) of the quaternion.
    pub w: f64,
}

impl Default for Quaternion {
    /// No rotation.
    fn default() -> Self {
        DQuat::IDENTITY.into()
    }
}

impl From<Quaternion> for DQuat {
    fn from(q: Quaternion) -> Self {
        Self::from_xyzw(q.x, q.y, q.z, q.w)
    }
}

impl From<DQuat> for Quaternion {
    fn from(q: DQuat) -> Self {
        let [x, y, z, w] = q.to_array();
        Self { x, y, z, w }
    }
}

/// Implements [`Message`](crate::wire::Message) from the name of the type in `feeler_msgs` and the lines of its text.
#[macro_export]
macro_rules! message {
    ($type:ident, $name:literal, $($line:expr),+ $(,)?) => {
        impl $crate::wire::Message for $type {
            const SCHEMA_NAME: &'static str = concat!("feeler_msgs/msg/", $name);
            const SCHEMA: &'static str = concat!($($line, "\n"),+);
        }
    };
}

/// Text of `geometry_msgs/Quaternion`, to be appended to a schema that uses it.
#[macro_export]
macro_rules! quaternion_schema {
    () => {
        "================================================================================\n\
         MSG: geometry_msgs/Quaternion\n\
         float64 x\n\
         float64 y\n\
         float64 z\n\
         float64 w"
    };
}

/// Text of `geometry_msgs/Vector3`, to be appended to a schema that uses it.
#[macro_export]
macro_rules! vector3_schema {
    () => {
        "================================================================================\n\
         MSG: geometry_msgs/Vector3\n\
         float64 x\n\
         float64 y\n\
         float64 z"
    };
}
