//! What stands before most messages.

use crate::channels::nanoseconds;
use serde::{Deserialize, Serialize};

/// Nanoseconds of a second.
const SECOND: u64 = 1_000_000_000;

/// A time, as ROS 2's `builtin_interfaces/Time`: of the run, not of the wall clock.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds after them.
    pub nanosec: u32,
}

impl Time {
    /// The time `stamp`, s, to the nanosecond; none if it is no time of a run.
    pub fn of(stamp: f64) -> Option<Self> {
        let ns = nanoseconds(stamp)?;
        Some(Self {
            sec: i32::try_from(ns / SECOND).ok()?,
            nanosec: (ns % SECOND) as u32,
        })
    }
}

/// What stands before most messages, `std_msgs/Header`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Time of what the message tells.
    pub stamp: Time,
    /// The frame that it is in.
    pub frame_id: String,
}

impl Header {
    /// Of what is in `frame`, at time 0.
    pub fn of(frame: impl Into<String>) -> Self {
        Self {
            stamp: Time::default(),
            frame_id: frame.into(),
        }
    }

    /// The stamp, s.
    pub fn seconds(&self) -> f64 {
        f64::from(self.stamp.sec) + f64::from(self.stamp.nanosec) * 1e-9
    }
}

/// The text of `name`, to stand after that of a message that uses it.
macro_rules! nested {
    ($name:literal, $($line:literal),+ $(,)?) => {
        concat!(
            "================================================================================\n",
            "MSG: ", $name, "\n",
            $($line, "\n"),+
        )
    };
}

/// The text of `std_msgs/Header`, to stand after that of a message that uses it.
macro_rules! header_schema {
    () => {
        concat!(
            $crate::ros::header::nested!(
                "std_msgs/Header",
                "builtin_interfaces/Time stamp",
                "string frame_id",
            ),
            $crate::ros::header::nested!("builtin_interfaces/Time", "int32 sec", "uint32 nanosec",),
        )
    };
}

/// The texts of `geometry_msgs` types, to stand after those of messages that use them.
macro_rules! xyz_schema {
    ($name:literal) => {
        $crate::ros::header::nested!($name, "float64 x", "float64 y", "float64 z")
    };
}

/// The text of `geometry_msgs/Quaternion`.
macro_rules! quaternion_schema {
    () => {
        $crate::ros::header::nested!(
            "geometry_msgs/Quaternion",
            "float64 x",
            "float64 y",
            "float64 z",
            "float64 w",
        )
    };
}

pub(super) use {header_schema, nested, quaternion_schema, xyz_schema};
