//! Type descriptions and their RIHS01 hashes (REP 2016), by which ROS 2 checks that two programs use the same type.
//! The hash is the SHA-256 of the description as JSON, without default values.

pub use crate::message_text::DescriptionError;
use crate::message_text::{IndividualType, add_text};
use feeler_record::wire::Message;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

/// Description of a type and its nested types.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TypeDescription {
    type_description: IndividualType,
    /// Nested types, sorted by name.
    referenced_type_descriptions: Vec<IndividualType>,
}

/// Definitions of the types nested in a service's event, except its request and response.
const EVENT_PARTS: &str = texts!("service_msgs/ServiceEventInfo", "builtin_interfaces/Time");

/// Type of a service, with its request and response messages.
pub trait Service {
    /// ROS 2 name of the service type.
    const NAME: &'static str;
    /// Request message, named like the service with the suffix `_Request`.
    type Request: Message;
    /// Response message, named like the service with the suffix `_Response`.
    type Response: Message;
}

impl TypeDescription {
    /// Creates the description of a message type.
    ///
    /// # Errors
    /// If the message text is invalid.
    pub fn of_message<M: Message>() -> Result<Self, DescriptionError> {
        let mut types = BTreeMap::new();
        add_text(M::SCHEMA_NAME, M::SCHEMA, &mut types)?;
        Self::collect(M::SCHEMA_NAME, &types)
    }

    /// Creates the description of a service type: its request, its response, and its service introspection event.
    ///
    /// # Errors
    /// If a message text is invalid.
    pub fn of_service<S: Service>() -> Result<Self, DescriptionError> {
        let mut types = BTreeMap::new();
        add_text(S::Request::SCHEMA_NAME, S::Request::SCHEMA, &mut types)?;
        add_text(S::Response::SCHEMA_NAME, S::Response::SCHEMA, &mut types)?;
        let [name, request, response] =
            [S::NAME, S::Request::SCHEMA_NAME, S::Response::SCHEMA_NAME];
        let event = format!("{name}_Event");
        let event_text = format!(
            "service_msgs/ServiceEventInfo info\n{request}[<=1] request\n{response}[<=1] response\n{EVENT_PARTS}"
        );
        add_text(&event, &event_text, &mut types)?;
        let text = format!(
            "{request} request_message\n{response} response_message\n{event} event_message\n"
        );
        add_text(name, &text, &mut types)?;
        Self::collect(name, &types)
    }

    /// Creates the description of the type `name` and its nested types. `types` must contain all of them.
    fn collect(
        name: &str,
        types: &BTreeMap<String, IndividualType>,
    ) -> Result<Self, DescriptionError> {
        let unknown = |by: &str, used: &str| DescriptionError::Unknown {
            type_name: by.into(),
            used: used.into(),
        };
        let whole = types.get(name).ok_or_else(|| unknown(name, name))?;
        let mut referenced = BTreeMap::new();
        let mut open = vec![whole];
        while let Some(user) = open.pop() {
            for used in user
                .fields
                .iter()
                .map(|field| &field.r#type.nested_type_name)
            {
                if used.is_empty() || referenced.contains_key(used) {
                    continue;
                }
                let found = types
                    .get(used)
                    .ok_or_else(|| unknown(&user.type_name, used))?;
                referenced.insert(used, found);
                open.push(found);
            }
        }
        Ok(Self {
            type_description: whole.clone(),
            referenced_type_descriptions: referenced.into_values().cloned().collect(),
        })
    }

    /// Returns the hash of the type as in keys and tokens: `RIHS01_` and 64 hexadecimal digits.
    pub fn hash(&self) -> String {
        let mut text = String::from("RIHS01_");
        for byte in Sha256::digest(self.json()) {
            // Writing to a string does not fail.
            let _ = write!(text, "{byte:02x}");
        }
        text
    }

    /// Returns the JSON text to hash.
    fn json(&self) -> Vec<u8> {
        let mut json = Vec::new();
        let mut serializer = serde_json::Serializer::with_formatter(&mut json, Spaced);
        // Serializing numbers and strings to memory does not fail.
        let _ = self.serialize(&mut serializer);
        json
    }
}

/// JSON formatter that writes a space after each comma and colon, like Python.
struct Spaced;

impl serde_json::ser::Formatter for Spaced {
    fn begin_array_value<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        out.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        out.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}
