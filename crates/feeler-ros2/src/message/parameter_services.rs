//! The services of `rcl_interfaces` by which tools see a node's parameters.

use super::parameter::{Parameter, ParameterDescriptor, ParameterValue, SetParametersResult};
use crate::type_description::Service;
use serde::{Deserialize, Serialize};

/// Which parameters there are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResult {
    /// Their names.
    pub names: Vec<String>,
    /// What stands before their last dot.
    pub prefixes: Vec<String>,
}

/// Asks which parameters there are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersRequest {
    /// What stands before a dot in their names; nothing for all.
    pub prefixes: Vec<String>,
    /// How many dots may follow; 0 for any.
    pub depth: u64,
}

/// Asks of some parameters.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamesRequest<const KIND: u8> {
    /// Their names.
    pub names: Vec<String>,
}

/// Asks to set some parameters.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SetParametersRequest<const ATOMICALLY: bool> {
    /// What they are to be.
    pub parameters: Vec<Parameter>,
}

/// Lists parameters.
#[derive(Debug, Clone, Copy)]
pub enum ListParameters {}

/// What [`ListParameters`] answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResponse {
    /// What there is.
    pub result: ListParametersResult,
}

impl Service for ListParameters {
    const NAME: &'static str = "rcl_interfaces/srv/ListParameters";
    type Request = ListParametersRequest;
    type Response = ListParametersResponse;
}

/// Tells values.
#[derive(Debug, Clone, Copy)]
pub enum GetParameters {}

/// What [`GetParameters`] answers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GetParametersResponse {
    /// One for each name; of type 0 where there is no such parameter.
    pub values: Vec<ParameterValue>,
}

impl Service for GetParameters {
    const NAME: &'static str = "rcl_interfaces/srv/GetParameters";
    type Request = NamesRequest<0>;
    type Response = GetParametersResponse;
}

/// Tells types.
#[derive(Debug, Clone, Copy)]
pub enum GetParameterTypes {}

/// What [`GetParameterTypes`] answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetParameterTypesResponse {
    /// One for each name; 0 where there is no such parameter.
    pub types: Vec<u8>,
}

impl Service for GetParameterTypes {
    const NAME: &'static str = "rcl_interfaces/srv/GetParameterTypes";
    type Request = NamesRequest<1>;
    type Response = GetParameterTypesResponse;
}

/// Describes parameters.
#[derive(Debug, Clone, Copy)]
pub enum DescribeParameters {}

/// What [`DescribeParameters`] answers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct DescribeParametersResponse {
    /// One for each name.
    pub descriptors: Vec<ParameterDescriptor>,
}

impl Service for DescribeParameters {
    const NAME: &'static str = "rcl_interfaces/srv/DescribeParameters";
    type Request = NamesRequest<2>;
    type Response = DescribeParametersResponse;
}

/// Sets parameters, each on its own.
#[derive(Debug, Clone, Copy)]
pub enum SetParameters {}

/// What [`SetParameters`] answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResponse {
    /// One for each parameter.
    pub results: Vec<SetParametersResult>,
}

impl Service for SetParameters {
    const NAME: &'static str = "rcl_interfaces/srv/SetParameters";
    type Request = SetParametersRequest<false>;
    type Response = SetParametersResponse;
}

/// Sets all of some parameters, or none.
#[derive(Debug, Clone, Copy)]
pub enum SetParametersAtomically {}

/// What [`SetParametersAtomically`] answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersAtomicallyResponse {
    /// For all.
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
