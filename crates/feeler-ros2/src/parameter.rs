//! A node's parameters: what tools see of its settings.

use crate::message::{
    DescribeParametersResponse, GetParameterTypesResponse, GetParametersResponse,
    ListParametersRequest, ListParametersResponse, ListParametersResult, Parameter,
    ParameterDescriptor, ParameterValue, SetParametersAtomicallyResponse, SetParametersResponse,
    SetParametersResult,
};
use serde_json::Value;

/// What parts of a name stand between.
const SEPARATOR: char = '.';

/// Parameters that can be read, and not set.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parameters {
    all: Vec<Parameter>,
    /// Why they cannot be set.
    reason: String,
}

impl Parameters {
    /// None yet; `reason` says why none can be set.
    pub fn new(reason: &str) -> Self {
        Self {
            all: Vec::new(),
            reason: reason.into(),
        }
    }

    /// Adds a value, or all values of a table, each called by the keys on the way to it; a list of tables by the places there.
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
                self.all.extend(value.map(|value| Parameter {
                    name: name.into(),
                    value,
                }));
            }
        }
    }

    fn find(&self, name: &str) -> Option<&Parameter> {
        self.all.iter().find(|parameter| parameter.name == name)
    }

    /// Which there are, as `request` asks.
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
            .map(|p| p.name.as_str())
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

    /// The values of some.
    pub fn get(&self, names: &[String]) -> GetParametersResponse {
        let value = |name: &String| self.find(name).map(|p| p.value.clone());
        GetParametersResponse {
            values: names
                .iter()
                .map(|name| value(name).unwrap_or_default())
                .collect(),
        }
    }

    /// The types of some.
    pub fn types(&self, names: &[String]) -> GetParameterTypesResponse {
        let kind = |name: &String| self.find(name).map_or(0, |p| p.value.r#type);
        GetParameterTypesResponse {
            types: names.iter().map(kind).collect(),
        }
    }

    /// What there is to be known of some.
    pub fn describe(&self, names: &[String]) -> DescribeParametersResponse {
        let describe = |name: &String| ParameterDescriptor {
            name: name.clone(),
            r#type: self.find(name).map_or(0, |p| p.value.r#type),
            description: String::new(),
            additional_constraints: self.reason.clone(),
            read_only: true,
            ..ParameterDescriptor::default()
        };
        DescribeParametersResponse {
            descriptors: names.iter().map(describe).collect(),
        }
    }

    /// Refuses to set some, each on its own.
    pub fn set(&self, wanted: &[Parameter]) -> SetParametersResponse {
        SetParametersResponse {
            results: wanted
                .iter()
                .map(|parameter| self.refuse(parameter))
                .collect(),
        }
    }

    /// Refuses to set some together.
    pub fn set_atomically(&self, wanted: &[Parameter]) -> SetParametersAtomicallyResponse {
        let result = wanted.first().map(|parameter| self.refuse(parameter));
        SetParametersAtomicallyResponse {
            // Of nothing, all is set.
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
            None => format!("there is no parameter {name}"),
        };
        SetParametersResult {
            successful: false,
            reason,
        }
    }
}

/// A value that is no table; none where it is of no type that parameters have.
fn parameter_value(value: &Value) -> Option<ParameterValue> {
    let of_type = |r#type| ParameterValue {
        r#type,
        ..ParameterValue::default()
    };
    match value {
        Value::Bool(bool_value) => Some(ParameterValue {
            bool_value: *bool_value,
            ..of_type(1)
        }),
        Value::String(text) => Some(ParameterValue {
            string_value: text.clone(),
            ..of_type(4)
        }),
        Value::Number(number) => match number.as_i64() {
            Some(integer_value) => Some(ParameterValue {
                integer_value,
                ..of_type(2)
            }),
            None => Some(ParameterValue {
                double_value: number.as_f64()?,
                ..of_type(3)
            }),
        },
        Value::Array(list) => {
            let texts = list
                .iter()
                .map(|v| v.as_str().map(str::to_string))
                .collect();
            let doubles = list.iter().map(Value::as_f64).collect();
            match (texts, doubles) {
                (Some(string_array_value), _) => Some(ParameterValue {
                    string_array_value,
                    ..of_type(9)
                }),
                (_, Some(double_array_value)) => Some(ParameterValue {
                    double_array_value,
                    ..of_type(8)
                }),
                _ => None,
            }
        }
        Value::Null | Value::Object(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Parameters {
        let mut parameters = Parameters::new("it is fixed");
        let control = serde_json::json!({
            "law": "tri-axial", "touch_force": 0.1, "limits": { "speed": 2 }, "way": [1.0, 2.0],
            "finger": [{ "on": true }], "nothing": null,
        });
        parameters.add("control", &control);
        parameters
    }

    #[test]
    fn tables_become_names_with_dots() {
        let all = some().list(&ListParametersRequest::default()).result;
        let names = [
            "control.finger.0.on",
            "control.law",
            "control.limits.speed",
            "control.touch_force",
            "control.way",
        ];
        assert_eq!(all.names, names);
        assert_eq!(
            all.prefixes,
            ["control", "control.finger.0", "control.limits"]
        );
        assert_eq!(some().types(&all.names).types, [1, 4, 2, 3, 8]);
        let values = some()
            .get(&["control.touch_force".into(), "other".into()])
            .values;
        assert_eq!((values[0].double_value, values[1].r#type), (0.1, 0));
    }

    #[test]
    fn prefix_and_depth_choose() {
        let list = |prefix: &str, depth| {
            let prefixes = vec![prefix.to_string()];
            some()
                .list(&ListParametersRequest { prefixes, depth })
                .result
                .names
        };
        assert_eq!(
            list("control", 1),
            ["control.law", "control.touch_force", "control.way"]
        );
        assert_eq!(list("control.limits", 0), ["control.limits.speed"]);
        assert!(list("cont", 0).is_empty());
    }

    #[test]
    fn nothing_can_be_set_and_it_is_said_why() {
        let wanted = |name: &str| Parameter {
            name: name.into(),
            ..Parameter::default()
        };
        let results = some().set(&[wanted("control.law"), wanted("x")]).results;
        assert_eq!(results[0].reason, "control.law cannot be set: it is fixed");
        assert_eq!(results[1].reason, "there is no parameter x");
        assert!(results.iter().all(|result| !result.successful));
        assert!(!some().set_atomically(&[wanted("x")]).result.successful);
        assert!(some().describe(&["control.law".into()]).descriptors[0].read_only);
    }
}
