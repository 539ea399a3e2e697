//! Parameter services of a node.

use crate::message::{
    DescribeParameters, GetParameterTypes, GetParameters, ListParameters, SetParameters,
    SetParametersAtomically,
};
use crate::node::Node;
use crate::node_error::NodeError;
use crate::parameter::Parameters;
use std::sync::Arc;

/// Serves `parameters` through the parameter services of `node`.
///
/// # Errors
/// If the node's session is closed.
pub fn serve_parameters(node: &mut Node, parameters: Parameters) -> Result<(), NodeError> {
    let all = Arc::new(parameters);
    let of = || Arc::clone(&all);
    let (list, get, types) = (of(), of(), of());
    let (describe, set, together) = (of(), of(), of());
    node.serve::<ListParameters>("~/list_parameters", move |r| list.list(&r))?;
    node.serve::<GetParameters>("~/get_parameters", move |r| get.get(&r.names))?;
    node.serve::<GetParameterTypes>("~/get_parameter_types", move |r| types.types(&r.names))?;
    node.serve::<DescribeParameters>("~/describe_parameters", move |r| {
        describe.describe(&r.names)
    })?;
    node.serve::<SetParameters>("~/set_parameters", move |r| set.set(&r.parameters))?;
    node.serve::<SetParametersAtomically>("~/set_parameters_atomically", move |r| {
        together.set_atomically(&r.parameters)
    })
}
