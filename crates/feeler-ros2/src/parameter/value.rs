//! Conversion of an experiment's values to parameter values.

use crate::message::ParameterValue;
use serde_json::Value;

/// Converts a JSON value. Returns `None` for null, tables and lists of mixed types, which parameters do not support.
pub(super) fn parameter_value(value: &Value) -> Option<ParameterValue> {
    let of_type = |r#type| ParameterValue {
        r#type,
        ..ParameterValue::default()
    };
    match value {
        Value::Bool(bool_value) => Some(ParameterValue {
            bool_value: *bool_value,
            ..of_type(ParameterValue::BOOL)
        }),
        Value::String(text) => Some(ParameterValue {
            string_value: text.clone(),
            ..of_type(ParameterValue::STRING)
        }),
        Value::Number(number) => match number.as_i64() {
            Some(integer_value) => Some(ParameterValue {
                integer_value,
                ..of_type(ParameterValue::INTEGER)
            }),
            None => Some(ParameterValue {
                double_value: number.as_f64()?,
                ..of_type(ParameterValue::DOUBLE)
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
                    ..of_type(ParameterValue::STRING_ARRAY)
                }),
                (_, Some(double_array_value)) => Some(ParameterValue {
                    double_array_value,
                    ..of_type(ParameterValue::DOUBLE_ARRAY)
                }),
                _ => None,
            }
        }
        Value::Null | Value::Object(_) => None,
    }
}
