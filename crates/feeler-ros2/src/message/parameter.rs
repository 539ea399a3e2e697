//! Parameter messages of `rcl_interfaces`.

use serde::{Deserialize, Serialize};

/// Name and value of a parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name of the parameter.
    pub name: String,
    /// Value of the parameter.
    pub value: ParameterValue,
}

/// Value of a parameter; `type` selects the field that contains it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Type of the value, or 0 if the parameter is not set.
    pub r#type: u8,
    /// Value if the type is [`BOOL`](Self::BOOL).
    pub bool_value: bool,
    /// Value if the type is [`INTEGER`](Self::INTEGER).
    pub integer_value: i64,
    /// Value if the type is [`DOUBLE`](Self::DOUBLE).
    pub double_value: f64,
    /// Value if the type is [`STRING`](Self::STRING).
    pub string_value: String,
    /// Value if the type is 5.
    pub byte_array_value: Vec<u8>,
    /// Value if the type is 6.
    pub bool_array_value: Vec<bool>,
    /// Value if the type is 7.
    pub integer_array_value: Vec<i64>,
    /// Value if the type is [`DOUBLE_ARRAY`](Self::DOUBLE_ARRAY).
    pub double_array_value: Vec<f64>,
    /// Value if the type is [`STRING_ARRAY`](Self::STRING_ARRAY).
    pub string_array_value: Vec<String>,
}

impl ParameterValue {
    /// Type of [`bool_value`](Self::bool_value).
    pub const BOOL: u8 = 1;
    /// Type of [`integer_value`](Self::integer_value).
    pub const INTEGER: u8 = 2;
    /// Type of [`double_value`](Self::double_value).
    pub const DOUBLE: u8 = 3;
    /// Type of [`string_value`](Self::string_value).
    pub const STRING: u8 = 4;
    /// Type of [`double_array_value`](Self::double_array_value).
    pub const DOUBLE_ARRAY: u8 = 8;
    /// Type of [`string_array_value`](Self::string_array_value).
    pub const STRING_ARRAY: u8 = 9;
}

/// Description of a parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterDescriptor {
    /// Name of the parameter.
    pub name: String,
    /// Type of the value; see [`ParameterValue::type`].
    pub r#type: u8,
    /// Meaning and unit.
    pub description: String,
    /// Constraints that the ranges do not express.
    pub additional_constraints: String,
    /// `true` if the parameter cannot be set.
    pub read_only: bool,
    /// `true` if the type of the value may change.
    pub dynamic_typing: bool,
    /// Range of a floating-point value: at most one entry.
    pub floating_point_range: Vec<FloatingPointRange>,
    /// Range of an integer value: at most one entry.
    pub integer_range: Vec<IntegerRange>,
}

/// Range of a floating-point parameter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FloatingPointRange {
    /// Minimum, inclusive.
    pub from_value: f64,
    /// Maximum, inclusive.
    pub to_value: f64,
    /// Step between valid values, or 0 if any value in the range is valid.
    pub step: f64,
}

/// Range of an integer parameter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct IntegerRange {
    /// Minimum, inclusive.
    pub from_value: i64,
    /// Maximum, inclusive.
    pub to_value: i64,
    /// Step between valid values, or 0 if any value in the range is valid.
    pub step: u64,
}

/// Result of setting a parameter.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResult {
    /// `true` if the parameter was set.
    pub successful: bool,
    /// Reason why the parameter was not set; empty if it was set.
    pub reason: String,
}
