//! Read-only parameters that expose a node's settings to ROS 2 tools.

#[cfg(test)]
mod tests;
mod value;

use crate::message::{
    DescribeParametersResponse, FloatingPointRange, GetParameterTypesResponse,
    GetParametersResponse, IntegerRange, ListParametersRequest, ListParametersResponse,
    ListParametersResult, Parameter, ParameterDescriptor, ParameterValue,
    SetParametersAtomicallyResponse, SetParametersResponse, SetParametersResult,
};
use serde_json::Value;
use value::parameter_value;

/// Separator between the parts of a parameter's name.
const SEPARATOR: char = '.';

/// Read-only parameters of a node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parameters {
    all: Vec<ValueDescription>,
    /// Reason reported to clients that attempt to set a parameter.
    reason: String,
}

/// Description of a parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Meaning {
    /// Meaning and unit.
    pub description: String,
    /// Description of the valid values; empty if all are valid.
    pub expected: String,
    /// Minimum and maximum of a number, if these are its only constraints.
    pub range: Option<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq)]
struct ValueDescription {
    parameter: Parameter,
    meaning: Meaning,
}

impl Parameters {
    /// Creates an empty set of parameters. Attempts to set one are rejected with `reason`.
    pub fn new(reason: &str) -> Self {
        Self {
            all: Vec::new(),
            reason: reason.into(),
        }
    }

    /// Adds `value` as the parameter `name`. Tables and lists of tables become one parameter per value, with a name
    /// such as `control.finger.0.speed`. Values of types that parameters do not support are skipped.
    pub fn add(&mut self, name: &str, value: &Value) {
        let below = |key: &str| format!("{name}{SEPARATOR}{key}");
        match value {
            Value::Object(table) => {
                for (key, value) in table {
                    self.add(&below(key), value);
                }
            }
            Value::Array(list) if list.iter().any(Value::is_object) => {
                for (place, value) in list.iter().enumerate() {
                    self.add(&below(&place.to_string()), value);
                }
            }
            value => {
                let value = parameter_value(value);
                self.all.extend(value.map(|value| ValueDescription {
                    parameter: Parameter {
                        name: name.into(),
                        value,
                    },
                    meaning: Meaning::default(),
                }));
            }
        }
    }

    /// Sets the description of each parameter to `meaning(name)`; empty if that is `None`.
    pub fn describe_by(&mut self, meaning: impl Fn(&str) -> Option<Meaning>) {
        for one in &mut self.all {
            one.meaning = meaning(&one.parameter.name).unwrap_or_default();
        }
    }

    fn find(&self, name: &str) -> Option<&ValueDescription> {
        self.all.iter().find(|one| one.parameter.name == name)
    }

    /// Lists the names that match the prefixes and depth of `request`.
    pub fn list(&self, request: &ListParametersRequest) -> ListParametersResponse {
        let depth = usize::try_from(request.depth).unwrap_or(usize::MAX);
        let shallow = |rest: &str| depth == 0 || rest.matches(SEPARATOR).count() < depth;
        let listed = |name: &str| match request.prefixes.as_slice() {
            [] => shallow(name),
            prefixes => prefixes.iter().any(|prefix| {
                let rest = name.strip_prefix(prefix.as_str());
                rest.is_some_and(|rest| {
                    rest.is_empty() || rest.strip_prefix(SEPARATOR).is_some_and(shallow)
                })
            }),
        };
        let names = self
            .all
            .iter()
            .map(|one| one.parameter.name.as_str())
            .filter(|name| listed(name));
        let mut result = ListParametersResult::default();
        for name in names {
            result.names.push(name.into());
            if let Some((prefix, _)) = name.rsplit_once(SEPARATOR) {
                result.prefixes.push(prefix.into());
            }
        }
        result.prefixes.sort();
        result.prefixes.dedup();
        ListParametersResponse { result }
    }

    /// Returns the values of the parameters `names`; unknown ones have type 0.
    pub fn get(&self, names: &[String]) -> GetParametersResponse {
        let value = |name: &String| self.find(name).map(|one| one.parameter.value.clone());
        GetParametersResponse {
            values: names
                .iter()
                .map(|name| value(name).unwrap_or_default())
                .collect(),
        }
    }

    /// Returns the types of the parameters `names`; 0 for unknown ones.
    pub fn types(&self, names: &[String]) -> GetParameterTypesResponse {
        let kind = |name: &String| self.find(name).map_or(0, |one| one.parameter.value.r#type);
        GetParameterTypesResponse {
            types: names.iter().map(kind).collect(),
        }
    }

    /// Returns the descriptors of the parameters `names`; unknown ones contain only the name.
    pub fn describe(&self, names: &[String]) -> DescribeParametersResponse {
        let describe = |name: &String| match self.find(name) {
            Some(one) => self.descriptor(one),
            None => ParameterDescriptor {
                name: name.clone(),
                ..ParameterDescriptor::default()
            },
        };
        DescribeParametersResponse {
            descriptors: names.iter().map(describe).collect(),
        }
    }

    fn descriptor(
        &self,
        ValueDescription { parameter, meaning }: &ValueDescription,
    ) -> ParameterDescriptor {
        let mut descriptor = ParameterDescriptor {
            name: parameter.name.clone(),
            r#type: parameter.value.r#type,
            description: meaning.description.clone(),
            additional_constraints: match meaning.expected.as_str() {
                "" => self.reason.clone(),
                expected => format!("{expected}; {}", self.reason),
            },
            read_only: true,
            ..ParameterDescriptor::default()
        };
        if let Some([from_value, to_value]) = meaning.range {
            match parameter.value.r#type {
                ParameterValue::INTEGER => descriptor.integer_range.push(IntegerRange {
                    from_value: from_value as i64,
                    to_value: to_value as i64,
                    step: 0,
                }),
                ParameterValue::DOUBLE => {
                    descriptor.floating_point_range.push(FloatingPointRange {
                        from_value,
                        to_value,
                        step: 0.0,
                    })
                }
                _ => {}
            }
        }
        descriptor
    }

    /// Rejects a request to set parameters, with the reason for each parameter.
    pub fn set(&self, wanted: &[Parameter]) -> SetParametersResponse {
        SetParametersResponse {
            results: wanted
                .iter()
                .map(|parameter| self.refuse(parameter))
                .collect(),
        }
    }

    /// Rejects a request to set parameters atomically, unless it is empty.
    pub fn set_atomically(&self, wanted: &[Parameter]) -> SetParametersAtomicallyResponse {
        let result = wanted.first().map(|parameter| self.refuse(parameter));
        SetParametersAtomicallyResponse {
            result: result.unwrap_or(SetParametersResult {
                successful: true,
                reason: String::new(),
            }),
        }
    }

    fn refuse(&self, parameter: &Parameter) -> SetParametersResult {
        let name = &parameter.name;
        let reason = match self.find(name) {
            Some(_) => format!("{name} cannot be set: {}", self.reason),
            None => format!("unknown parameter {name}"),
        };
        SetParametersResult {
            successful: false,
            reason,
        }
    }
}
