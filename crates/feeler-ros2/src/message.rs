//! Messages and services that a recording has none of: their structs and texts are those of `rcl_interfaces` and `common_interfaces`.

mod array;
mod clock;
mod diagnostic;
mod parameters;
mod tactile_state;
mod trigger;

pub use array::{Float64MultiArray, MultiArrayDimension, MultiArrayLayout};
pub use clock::Clock;
pub use diagnostic::{DiagnosticArray, DiagnosticLevel, DiagnosticStatus, KeyValue};
pub use parameters::{
    DescribeParameters, DescribeParametersResponse, FloatingPointRange, GetParameterTypes,
    GetParameterTypesResponse, GetParameters, GetParametersResponse, IntegerRange, ListParameters,
    ListParametersRequest, ListParametersResponse, ListParametersResult, NamesRequest, Parameter,
    ParameterDescriptor, ParameterValue, SetParameters, SetParametersAtomically,
    SetParametersAtomicallyResponse, SetParametersRequest, SetParametersResponse,
    SetParametersResult,
};
pub use tactile_state::TactileState;
pub use trigger::{Trigger, TriggerRequest, TriggerResponse};
