//! A position in a TOML file in which keys may be missing.

use serde::de::Error;
use std::fmt;
use toml::Value;

/// Reason why deserialization stopped.
#[derive(Debug)]
pub(super) enum Stop {
    /// This key of the innermost table is missing.
    Key(&'static str),
    /// The key at this path is missing.
    At(String),
    /// Any other error.
    Other,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

impl std::error::Error for Stop {}

impl Error for Stop {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self::Other
    }

    fn missing_field(field: &'static str) -> Self {
        Self::Key(field)
    }
}

/// A position in the file and the value there.
#[derive(Clone)]
pub(super) struct Place<'a> {
    /// The value in the file. `None` for a placeholder, which yields a default of any requested type.
    pub(super) value: Option<&'a Value>,
    pub(super) path: String,
    /// Paths of the keys found missing so far.
    pub(super) missing: &'a [String],
    /// `true` if a placeholder table has all of its keys instead of only those in `missing`.
    pub(super) all: bool,
}

impl<'a> Place<'a> {
    /// Returns the position of the document's root. `missing` contains the paths of the keys found missing so far.
    pub(super) fn root(file: &'a Value, missing: &'a [String]) -> Self {
        Self {
            value: Some(file),
            path: String::new(),
            missing,
            all: false,
        }
    }

    pub(super) fn below(&self, key: &str, value: Option<&'a Value>) -> Self {
        let path = match self.path.as_str() {
            "" => key.to_string(),
            path => format!("{path}.{key}"),
        };
        Self {
            value,
            path,
            ..self.clone()
        }
    }

    fn element(&self, index: usize, value: Option<&'a Value>) -> Self {
        let path = format!("{}[{index}]", self.path);
        Self {
            value,
            path,
            ..self.clone()
        }
    }

    /// Returns the entries of the table at this position: those in the file, then placeholders for missing ones.
    pub(super) fn entries(&self, fields: &[&'static str]) -> Vec<(String, Self)> {
        let table = self.value.and_then(Value::as_table);
        let there = table.into_iter().flatten();
        let mut entries: Vec<_> = there
            .map(|(key, value)| (key.clone(), self.below(key, Some(value))))
            .collect();
        for field in fields {
            let stand_in = self.below(field, None);
            let missing = self.value.is_none() && self.all || self.missing.contains(&stand_in.path);
            if missing {
                entries.push((field.to_string(), stand_in));
            }
        }
        entries
    }

    /// Returns the elements of the list at this position, or `stand_ins` placeholders if there is no list.
    pub(super) fn elements(&self, stand_ins: usize) -> Vec<Self> {
        match self.value.and_then(Value::as_array) {
            Some(values) => {
                let values = values.iter().enumerate();
                values
                    .map(|(i, value)| self.element(i, Some(value)))
                    .collect()
            }
            None => (0..stand_ins).map(|i| self.element(i, None)).collect(),
        }
    }
}
