//! Services of `rcl_interfaces` that give tools access to a node's parameters.

use super::parameter::{Parameter, ParameterDescriptor, ParameterValue, SetParametersResult};
use serde::{Deserialize, Serialize};

/// Names of parameters, listed by [`ListParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResult {
    /// Full names of the parameters.
    pub names: Vec<String>,
    /// Prefixes of the names, up to their last dot.
    pub prefixes: Vec<String>,
}

/// Request of [`ListParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersRequest {
    /// Prefixes of the names to list; empty for all.
    pub prefixes: Vec<String>,
    /// Maximum depth of names below a prefix; 0 for any.
    pub depth: u64,
}

/// Request with names of parameters. `KIND` distinguishes the request types of the services with this structure.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamesRequest<const KIND: u8> {
    /// Names of the parameters.
    pub names: Vec<String>,
}

/// Request of [`SetParameters`] or, if `ATOMICALLY`, [`SetParametersAtomically`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SetParametersRequest<const ATOMICALLY: bool> {
    /// Names and new values.
    pub parameters: Vec<Parameter>,
}

/// Response of [`ListParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResponse {
    /// Names of the parameters.
    pub result: ListParametersResult,
}

ros_service!(
    /// Service that lists parameters.
    ListParameters = "rcl_interfaces/srv/ListParameters",
    ListParametersRequest: "string[] prefixes\nuint64 depth\n";
    ListParametersResponse: "ListParametersResult result\n", "rcl_interfaces/ListParametersResult"
);

/// Response of [`GetParameters`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GetParametersResponse {
    /// Value for each name; its type is 0 if the parameter does not exist.
    pub values: Vec<ParameterValue>,
}

ros_service!(
    /// Service that returns values of parameters.
    GetParameters = "rcl_interfaces/srv/GetParameters",
    NamesRequest<0>: "string[] names\n";
    GetParametersResponse: "ParameterValue[] values\n", "rcl_interfaces/ParameterValue"
);

/// Response of [`GetParameterTypes`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetParameterTypesResponse {
    /// Type for each name; 0 if the parameter does not exist.
    pub types: Vec<u8>,
}

ros_service!(
    /// Service that returns types of parameters.
    GetParameterTypes = "rcl_interfaces/srv/GetParameterTypes",
    NamesRequest<1>: "string[] names\n";
    GetParameterTypesResponse: "uint8[] types\n"
);

/// Response of [`DescribeParameters`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct DescribeParametersResponse {
    /// Descriptor for each name.
    pub descriptors: Vec<ParameterDescriptor>,
}

ros_service!(
    /// Service that describes parameters.
    DescribeParameters = "rcl_interfaces/srv/DescribeParameters",
    NamesRequest<2>: "string[] names\n";
    DescribeParametersResponse: "ParameterDescriptor[] descriptors\n",
        "rcl_interfaces/ParameterDescriptor",
        "rcl_interfaces/FloatingPointRange",
        "rcl_interfaces/IntegerRange"
);

/// Response of [`SetParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResponse {
    /// Result for each parameter.
    pub results: Vec<SetParametersResult>,
}

ros_service!(
    /// Service that sets each of the given parameters separately.
    SetParameters = "rcl_interfaces/srv/SetParameters",
    SetParametersRequest<false>: "Parameter[] parameters\n",
        "rcl_interfaces/Parameter",
        "rcl_interfaces/ParameterValue";
    SetParametersResponse: "SetParametersResult[] results\n", "rcl_interfaces/SetParametersResult"
);

/// Response of [`SetParametersAtomically`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersAtomicallyResponse {
    /// Result for the whole request.
    pub result: SetParametersResult,
}

ros_service!(
    /// Service that sets either all given parameters or none.
    SetParametersAtomically = "rcl_interfaces/srv/SetParametersAtomically",
    SetParametersRequest<true>: "Parameter[] parameters\n",
        "rcl_interfaces/Parameter",
        "rcl_interfaces/ParameterValue";
    SetParametersAtomicallyResponse: "SetParametersResult result\n",
        "rcl_interfaces/SetParametersResult"
);
