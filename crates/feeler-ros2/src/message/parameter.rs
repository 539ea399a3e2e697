//! What `rcl_interfaces` says of parameters.

use serde::{Deserialize, Serialize};

/// A parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// What it is called.
    pub name: String,
    /// What it is.
    pub value: ParameterValue,
}

/// What a parameter is: the field that `type` says.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Which field counts: 0 for none, then from 1 in their order.
    pub r#type: u8,
    /// Type 1.
    pub bool_value: bool,
    /// Type 2.
    pub integer_value: i64,
    /// Type 3.
    pub double_value: f64,
    /// Type 4.
    pub string_value: String,
    /// Type 5.
    pub byte_array_value: Vec<u8>,
    /// Type 6.
    pub bool_array_value: Vec<bool>,
    /// Type 7.
    pub integer_array_value: Vec<i64>,
    /// Type 8.
    pub double_array_value: Vec<f64>,
    /// Type 9.
    pub string_array_value: Vec<String>,
}

impl ParameterValue {
    /// [`bool_value`](Self::bool_value) counts.
    pub const BOOL: u8 = 1;
    /// [`integer_value`](Self::integer_value) counts.
    pub const INTEGER: u8 = 2;
    /// [`double_value`](Self::double_value) counts.
    pub const DOUBLE: u8 = 3;
    /// [`string_value`](Self::string_value) counts.
    pub const STRING: u8 = 4;
    /// [`double_array_value`](Self::double_array_value) counts.
    pub const DOUBLE_ARRAY: u8 = 8;
    /// [`string_array_value`](Self::string_array_value) counts.
    pub const STRING_ARRAY: u8 = 9;
}

/// What there is to be known of a parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterDescriptor {
    /// What it is called.
    pub name: String,
    /// As [`ParameterValue::type`].
    pub r#type: u8,
    /// What it means.
    pub description: String,
    /// What it can be, in words.
    pub additional_constraints: String,
    /// Whether it cannot be set.
    pub read_only: bool,
    /// Whether it can change its type.
    pub dynamic_typing: bool,
    /// What a number can be: none or one.
    pub floating_point_range: Vec<FloatingPointRange>,
    /// What a whole number can be: none or one.
    pub integer_range: Vec<IntegerRange>,
}

/// What a number can be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FloatingPointRange {
    /// The least.
    pub from_value: f64,
    /// The greatest.
    pub to_value: f64,
    /// From one to the next; 0 for any.
    pub step: f64,
}

/// What a whole number can be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct IntegerRange {
    /// The least.
    pub from_value: i64,
    /// The greatest.
    pub to_value: i64,
    /// From one to the next; 0 for any.
    pub step: u64,
}

/// Whether a parameter was set.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResult {
    /// Whether it was.
    pub successful: bool,
    /// Why not.
    pub reason: String,
}
