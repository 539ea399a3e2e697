//! Finds the first difference between two configurations, for messages.

use serde::Serialize;
use toml::Value;

/// First value that differs between two configurations, `left` and `right`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::sensor) struct Difference {
    /// Key of the value, as in `rings[1].elements`.
    pub key: String,
    /// Value in `left`, as text.
    pub left: String,
    /// Value in `right`, as text.
    pub right: String,
}

/// Finds the first value that differs between `left` and `right`, which must not be equal.
pub(in crate::sensor) fn first_difference<T: Serialize>(left: &T, right: &T) -> Difference {
    match (Value::try_from(left), Value::try_from(right)) {
        (Ok(left), Ok(right)) => descend(String::new(), Some(&left), Some(&right)),
        // A value that cannot be represented in TOML has no keys.
        _ => difference("a value".into(), None, None),
    }
}

/// Descends recursively into tables and arrays that are present on both sides.
fn descend(key: String, left: Option<&Value>, right: Option<&Value>) -> Difference {
    match (left, right) {
        (Some(Value::Table(a)), Some(Value::Table(b))) => {
            let mut names = a.keys().chain(b.keys());
            let name = names.find(|&name| a.get(name) != b.get(name));
            let dot = if key.is_empty() { "" } else { "." };
            match name {
                Some(name) => descend(format!("{key}{dot}{name}"), a.get(name), b.get(name)),
                None => difference(key, left, right),
            }
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) => {
            let mut indices = 0..a.len().max(b.len());
            match indices.find(|&i| a.get(i) != b.get(i)) {
                Some(i) => descend(format!("{key}[{i}]"), a.get(i), b.get(i)),
                None => difference(key, left, right),
            }
        }
        _ => difference(key, left, right),
    }
}

fn difference(key: String, left: Option<&Value>, right: Option<&Value>) -> Difference {
    let text = |value: Option<&Value>| value.map_or("nothing".into(), Value::to_string);
    Difference {
        key,
        left: text(left),
        right: text(right),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::fingertip::layout::LayoutConfig;

    #[test]
    fn the_value_that_differs_is_named() {
        let reference = LayoutConfig::default();
        let mut other = reference.clone();
        other.rings[2].elements = 13;
        let Difference { key, left, right } = first_difference(&reference, &other);
        assert_eq!([&*key, &*left, &*right], ["rings[2].elements", "12", "13"]);
        other = reference.clone();
        other.rings.pop();
        let Difference { key, right, .. } = first_difference(&reference, &other);
        assert_eq!([&*key, &*right], ["rings[3]", "nothing"]);
    }
}
