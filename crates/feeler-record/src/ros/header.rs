//! `std_msgs/Header`, the header of most messages.

use crate::messages::channels::nanoseconds;
use serde::{Deserialize, Serialize};

/// Nanoseconds per second.
const SECOND: u64 = 1_000_000_000;

/// A run time in the format of ROS 2's `builtin_interfaces/Time`. Not a wall-clock time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Additional nanoseconds.
    pub nanosec: u32,
}

impl Time {
    /// Rounds `stamp` (s) to the nearest nanosecond. `None` if it is not a valid time of a run.
    pub fn of(stamp: f64) -> Option<Self> {
        let ns = nanoseconds(stamp)?;
        Some(Self {
            sec: i32::try_from(ns / SECOND).ok()?,
            nanosec: (ns % SECOND) as u32,
        })
    }
}

/// Header of most messages, `std_msgs/Header`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Time of the message's data.
    pub stamp: Time,
    /// Coordinate frame of the message's data.
    pub frame_id: String,
}

impl Header {
    /// Creates a header for data in `frame` at time 0.
    pub fn of(frame: impl Into<String>) -> Self {
        Self {
            stamp: Time::default(),
            frame_id: frame.into(),
        }
    }

    /// The stamp in seconds.
    pub fn seconds(&self) -> f64 {
        f64::from(self.stamp.sec) + f64::from(self.stamp.nanosec) * 1e-9
    }
}

/// Text of the type `name`, to be appended to the text of a message that uses it.
macro_rules! nested {
    ($name:literal $(, $line:literal)* $(,)?) => {
        concat!(
            "================================================================================\n",
            "MSG: ", $name, "\n",
            $($line, "\n",)*
        )
    };
}

/// Text of `std_msgs/Header`, to be appended to the text of a message that uses it.
macro_rules! header_schema {
    () => {
        concat!(
            $crate::ros::nested!(
                "std_msgs/Header",
                "builtin_interfaces/Time stamp",
                "string frame_id",
            ),
            $crate::ros::nested!("builtin_interfaces/Time", "int32 sec", "uint32 nanosec",),
        )
    };
}

/// Text of a `geometry_msgs` type with components x, y and z, to be appended to the text of a message that uses it.
macro_rules! xyz_schema {
    ($name:literal) => {
        $crate::ros::nested!($name, "float64 x", "float64 y", "float64 z")
    };
}

/// The text of `geometry_msgs/Quaternion`.
macro_rules! quaternion_schema {
    () => {
        $crate::ros::nested!(
            "geometry_msgs/Quaternion",
            "float64 x",
            "float64 y",
            "float64 z",
            "float64 w",
        )
    };
}

pub(crate) use {header_schema, nested, quaternion_schema, xyz_schema};
