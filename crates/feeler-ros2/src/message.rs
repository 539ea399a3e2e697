//! ROS 2 messages and services that recordings do not contain, as defined by ROS 2 and `feeler_msgs`.

mod array;
mod clock;
mod diagnostic;
mod gripper_command;
mod parameter;
mod parameter_services;
mod tactile_state;
mod trigger;

pub use array::{Float64MultiArray, MultiArrayDimension, MultiArrayLayout};
pub use clock::Clock;
pub use diagnostic::{DiagnosticArray, DiagnosticLevel, DiagnosticStatus, KeyValue};
pub use gripper_command::{SendGripperGoal, SendGripperGoalRequest, SendGripperGoalResponse};
pub use parameter::{
    FloatingPointRange, IntegerRange, Parameter, ParameterDescriptor, ParameterValue,
    SetParametersResult,
};
pub use parameter_services::{
    DescribeParameters, DescribeParametersResponse, GetParameterTypes, GetParameterTypesResponse,
    GetParameters, GetParametersResponse, ListParameters, ListParametersRequest,
    ListParametersResponse, ListParametersResult, NamesRequest, SetParameters,
    SetParametersAtomically, SetParametersAtomicallyResponse, SetParametersRequest,
    SetParametersResponse,
};
pub use tactile_state::TactileState;
pub use trigger::{Trigger, TriggerRequest, TriggerResponse};
