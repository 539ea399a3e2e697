//! `std_msgs/Float64MultiArray`.

use serde::{Deserialize, Serialize};

/// Numbers, and how they are to be read.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// How they are to be read.
    pub layout: MultiArrayLayout,
    /// The numbers.
    pub data: Vec<f64>,
}

/// How an array's numbers are to be read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// Its dimensions.
    pub dim: Vec<MultiArrayDimension>,
    /// Numbers before the first.
    pub data_offset: u32,
}

/// A dimension of an array.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// What it is called.
    pub label: String,
    /// How long it is.
    pub size: u32,
    /// Numbers from one to the next.
    pub stride: u32,
}

ros_message!(
    Float64MultiArray,
    "std_msgs/msg/Float64MultiArray",
    include_str!("../../msg/std_msgs/Float64MultiArray.msg"),
    "std_msgs/MultiArrayLayout",
    "std_msgs/MultiArrayDimension",
);
