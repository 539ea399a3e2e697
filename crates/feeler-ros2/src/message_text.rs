//! Parser of `.msg` texts.

use serde::Serialize;
use std::collections::BTreeMap;

/// Error when parsing a message text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DescriptionError {
    /// A line is not a field.
    #[error("{type_name}: expected a field such as \"float64[3] position\", got {line:?}")]
    Field {
        /// Type that the text describes.
        type_name: String,
        /// Text of the line.
        line: String,
    },
    /// The definition of a nested type is missing.
    #[error("{type_name} uses {used}, whose text is missing")]
    Unknown {
        /// Type that uses the nested type.
        type_name: String,
        /// Name of the nested type.
        used: String,
    },
}

/// Name and fields of one type: `type_description_interfaces/msg/IndividualTypeDescription`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct IndividualType {
    pub type_name: String,
    pub fields: Vec<Field>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Field {
    pub name: String,
    pub r#type: FieldType,
}

#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct FieldType {
    pub type_id: u8,
    pub capacity: u64,
    pub string_capacity: u64,
    pub nested_type_name: String,
}

/// Start of the separator lines between the texts of types.
const RULE: &str = "====";

/// Identifiers of primitive types, as in `type_description_interfaces/msg/FieldType`.
const PRIMITIVES: [(&str, u8); 15] = [
    ("int8", 2),
    ("uint8", 3),
    ("char", 3),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    ("bool", 15),
    ("byte", 16),
    ("string", STRING),
    ("wstring", WSTRING),
];
const NESTED: u8 = 1;
const STRING: u8 = 17;
const WSTRING: u8 = 18;
/// Offset of the identifier of bounded strings from that of unbounded strings.
const BOUNDED: u8 = 4;
/// Offset of the identifier of an array from that of its element type.
const ARRAY: u8 = 48;
/// Offset of the identifier of a bounded sequence from that of its element type.
const BOUNDED_SEQUENCE: u8 = 96;
/// Offset of the identifier of an unbounded sequence from that of its element type.
const SEQUENCE: u8 = 144;

/// Parses `text`, which contains the definition of the type `name` and then those of nested types, and adds all types
/// to `types`.
pub fn add_text(
    name: &str,
    text: &str,
    types: &mut BTreeMap<String, IndividualType>,
) -> Result<(), DescriptionError> {
    let mut current = IndividualType {
        type_name: name.into(),
        fields: Vec::new(),
    };
    for line in text.lines() {
        if let Some(other) = line.strip_prefix("MSG: ") {
            let next = IndividualType {
                type_name: whole_name(other.trim(), name),
                fields: Vec::new(),
            };
            let done = std::mem::replace(&mut current, next);
            types.insert(done.type_name.clone(), done);
        } else if !line.starts_with(RULE) {
            let field = field(line, &current.type_name)?;
            current.fields.extend(field);
        }
    }
    types.insert(current.type_name.clone(), current);
    // Empty messages get a placeholder field, as a C struct cannot be empty.
    for empty in types.values_mut().filter(|t| t.fields.is_empty()) {
        empty.fields.push(Field {
            name: "structure_needs_at_least_one_member".into(),
            r#type: FieldType {
                type_id: 3,
                ..FieldType::default()
            },
        });
    }
    Ok(())
}

/// Parses one line in the text of the type `of`. Returns `None` for a constant, a comment or an empty line.
fn field(line: &str, of: &str) -> Result<Option<Field>, DescriptionError> {
    let code = line.split('#').next().unwrap_or_default().trim();
    if code.is_empty() {
        return Ok(None);
    }
    let wrong = || DescriptionError::Field {
        type_name: of.into(),
        line: line.into(),
    };
    let (kind, rest) = code.split_once(char::is_whitespace).ok_or_else(wrong)?;
    let rest = rest.trim_start();
    // A default value may follow the name; it is not part of the description.
    let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let (name, value) = rest.split_at(end.unwrap_or(rest.len()));
    if value.trim_start().starts_with('=') {
        return Ok(None);
    }
    let r#type = field_type(kind, of).ok_or_else(wrong)?;
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => Ok(Some(Field {
            name: name.into(),
            r#type,
        })),
        false => Err(wrong()),
    }
}

/// Parses a type such as `Point[<=3]` in the text of the type `of`. Returns `None` if it is invalid.
fn field_type(text: &str, of: &str) -> Option<FieldType> {
    let (text, array) = match text.strip_suffix(']') {
        Some(array) => array
            .rsplit_once('[')
            .map(|(base, size)| (base, Some(size)))?,
        None => (text, None),
    };
    let (base, string_capacity) = match text.split_once("<=") {
        Some((base, most)) => (base, most.parse().ok()?),
        None => (text, 0),
    };
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '/';
    if base.is_empty() || !base.chars().all(is_part) {
        return None;
    }
    let primitive = PRIMITIVES.iter().find(|(name, _)| *name == base);
    let mut type_id = primitive.map_or(NESTED, |(_, id)| *id);
    if string_capacity > 0 {
        type_id = matches!(type_id, STRING | WSTRING).then_some(type_id + BOUNDED)?;
    }
    let (added, capacity) = match array {
        None => (0, 0),
        Some("") => (SEQUENCE, 0),
        Some(size) => match size.strip_prefix("<=") {
            Some(most) => (BOUNDED_SEQUENCE, most.parse().ok()?),
            None => (ARRAY, size.parse().ok()?),
        },
    };
    Some(FieldType {
        type_id: type_id + added,
        capacity,
        string_capacity,
        nested_type_name: match primitive {
            Some(_) => String::new(),
            None => whole_name(base, of),
        },
    })
}

/// Returns the full name of a type, such as `geometry_msgs/msg/Point` for `geometry_msgs/Point`, or for `Point` in the
/// text of a type `of` in `geometry_msgs`.
fn whole_name(name: &str, of: &str) -> String {
    match name.split('/').count() {
        1 => format!("{}/msg/{name}", of.split('/').next().unwrap_or_default()),
        2 => name.replace('/', "/msg/"),
        _ => name.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_parsed_and_constants_skipped() {
        let read = |line: &str| {
            let field = field(line, "a_msgs/msg/A").unwrap()?;
            let FieldType {
                type_id,
                capacity,
                string_capacity,
                nested_type_name,
            } = field.r#type;
            Some((
                field.name,
                type_id,
                capacity,
                string_capacity,
                nested_type_name,
            ))
        };
        let plain =
            |name: &str, id, capacity, most| Some((name.into(), id, capacity, most, String::new()));
        assert_eq!(read("uint8 X=3"), None);
        assert_eq!(read("string NAME = \"a\"  # b"), None);
        assert_eq!(read("  # only this"), None);
        assert_eq!(read("bool read_only false"), plain("read_only", 15, 0, 0));
        assert_eq!(read("char[16] gid"), plain("gid", 51, 16, 0));
        assert_eq!(
            read("string<=10[<=3] names"),
            plain("names", 21 + 96, 3, 10)
        );
        let nested = |name: &str, id, used: &str| Some((name.into(), id, 0, 0, used.into()));
        assert_eq!(read("Point at"), nested("at", 1, "a_msgs/msg/Point"));
        assert_eq!(read("b/Point[] at"), nested("at", 145, "b/msg/Point"));
    }

    #[test]
    fn invalid_fields_are_rejected() {
        for line in [
            "float64",
            "float64 1x",
            "float64[x] a",
            "float64[ a",
            "Point<=3 a",
            "int8 ",
        ] {
            let mut types = BTreeMap::new();
            assert!(add_text("a/msg/A", line, &mut types).is_err(), "{line}");
        }
    }
}
