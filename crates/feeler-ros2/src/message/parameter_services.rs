//! Services of `rcl_interfaces` that give tools access to a node's parameters.

use super::parameter::{Parameter, ParameterDescriptor, ParameterValue, SetParametersResult};
use crate::type_description::Service;
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

/// Service that lists parameters.
#[derive(Debug, Clone, Copy)]
pub enum ListParameters {}

/// Response of [`ListParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResponse {
    /// Names of the parameters.
    pub result: ListParametersResult,
}

impl Service for ListParameters {
    const NAME: &'static str = "rcl_interfaces/srv/ListParameters";
    type Request = ListParametersRequest;
    type Response = ListParametersResponse;
}

/// Service that returns values of parameters.
#[derive(Debug, Clone, Copy)]
pub enum GetParameters {}

/// Response of [`GetParameters`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GetParametersResponse {
    /// Value for each name; its type is 0 if the parameter does not exist.
    pub values: Vec<ParameterValue>,
}

impl Service for GetParameters {
    const NAME: &'static str = "rcl_interfaces/srv/GetParameters";
    type Request = NamesRequest<0>;
    type Response = GetParametersResponse;
}

/// Service that returns types of parameters.
#[derive(Debug, Clone, Copy)]
pub enum GetParameterTypes {}

/// Response of [`GetParameterTypes`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetParameterTypesResponse {
    /// Type for each name; 0 if the parameter does not exist.
    pub types: Vec<u8>,
}

impl Service for GetParameterTypes {
    const NAME: &'static str = "rcl_interfaces/srv/GetParameterTypes";
    type Request = NamesRequest<1>;
    type Response = GetParameterTypesResponse;
}

/// Service that describes parameters.
#[derive(Debug, Clone, Copy)]
pub enum DescribeParameters {}

/// Response of [`DescribeParameters`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct DescribeParametersResponse {
    /// Descriptor for each name.
    pub descriptors: Vec<ParameterDescriptor>,
}

impl Service for DescribeParameters {
    const NAME: &'static str = "rcl_interfaces/srv/DescribeParameters";
    type Request = NamesRequest<2>;
    type Response = DescribeParametersResponse;
}

/// Service that sets each of the given parameters separately.
#[derive(Debug, Clone, Copy)]
pub enum SetParameters {}

/// Response of [`SetParameters`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResponse {
    /// Result for each parameter.
    pub results: Vec<SetParametersResult>,
}

impl Service for SetParameters {
    const NAME: &'static str = "rcl_interfaces/srv/SetParameters";
    type Request = SetParametersRequest<false>;
    type Response = SetParametersResponse;
}

/// Service that sets either all given parameters or none.
#[derive(Debug, Clone, Copy)]
pub enum SetParametersAtomically {}

/// Response of [`SetParametersAtomically`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersAtomicallyResponse {
    /// Result for the whole request.
    pub result: SetParametersResult,
}

impl Service for SetParametersAtomically {
    const NAME: &'static str = "rcl_interfaces/srv/SetParametersAtomically";
    type Request = SetParametersRequest<true>;
    type Response = SetParametersAtomicallyResponse;
}

ros_message!(
    ListParametersRequest,
    "rcl_interfaces/srv/ListParameters_Request",
    "string[] prefixes\nuint64 depth\n"
);
ros_message!(
    ListParametersResponse,
    "rcl_interfaces/srv/ListParameters_Response",
    "ListParametersResult result\n",
    "rcl_interfaces/ListParametersResult"
);
ros_message!(
    NamesRequest<0>,
    "rcl_interfaces/srv/GetParameters_Request",
    "string[] names\n"
);
ros_message!(
    GetParametersResponse,
    "rcl_interfaces/srv/GetParameters_Response",
    "ParameterValue[] values\n",
    "rcl_interfaces/ParameterValue"
);
ros_message!(
    NamesRequest<1>,
    "rcl_interfaces/srv/GetParameterTypes_Request",
    "string[] names\n"
);
ros_message!(
    GetParameterTypesResponse,
    "rcl_interfaces/srv/GetParameterTypes_Response",
    "uint8[] types\n"
);
ros_message!(
    NamesRequest<2>,
    "rcl_interfaces/srv/DescribeParameters_Request",
    "string[] names\n"
);
ros_message!(
    DescribeParametersResponse,
    "rcl_interfaces/srv/DescribeParameters_Response",
    "ParameterDescriptor[] descriptors\n",
    "rcl_interfaces/ParameterDescriptor",
    "rcl_interfaces/FloatingPointRange",
    "rcl_interfaces/IntegerRange"
);
ros_message!(
    SetParametersRequest<false>,
    "rcl_interfaces/srv/SetParameters_Request",
    "Parameter[] parameters\n",
    "rcl_interfaces/Parameter",
    "rcl_interfaces/ParameterValue"
);
ros_message!(
    SetParametersResponse,
    "rcl_interfaces/srv/SetParameters_Response",
    "SetParametersResult[] results\n",
    "rcl_interfaces/SetParametersResult"
);
ros_message!(
    SetParametersRequest<true>,
    "rcl_interfaces/srv/SetParametersAtomically_Request",
    "Parameter[] parameters\n",
    "rcl_interfaces/Parameter",
    "rcl_interfaces/ParameterValue"
);
ros_message!(
    SetParametersAtomicallyResponse,
    "rcl_interfaces/srv/SetParametersAtomically_Response",
    "SetParametersResult result\n",
    "rcl_interfaces/SetParametersResult"
);
