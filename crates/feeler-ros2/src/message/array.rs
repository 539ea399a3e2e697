//! `std_msgs/Float64MultiArray`.

use serde::{Deserialize, Serialize};

/// Multidimensional array of numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// Dimensions of the array.
    pub layout: MultiArrayLayout,
    /// Elements of the array.
    pub data: Vec<f64>,
}

/// Layout of an array.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// Dimensions, outermost first.
    pub dim: Vec<MultiArrayDimension>,
    /// Number of elements of `data` before the array's first element.
    pub data_offset: u32,
}

/// One dimension of an array.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// Name of the dimension.
    pub label: String,
    /// Number of elements.
    pub size: u32,
    /// Stride in elements.
    pub stride: u32,
}

ros_message!(
    Float64MultiArray,
    "std_msgs/msg/Float64MultiArray",
    include_str!("../../msg/std_msgs/Float64MultiArray.msg"),
    "std_msgs/MultiArrayLayout",
    "std_msgs/MultiArrayDimension",
);
