//! Liveliness tokens: by these, nodes of a graph know of each other.
//!
//! A node is `@ros2_lv/<domain>/<session>/<node id>/<node id>/NN/<enclave>/<namespace>/<name>`; what it publishes, subscribes to, serves
//! and calls has an id of its own, another kind, and behind the node's name `/<topic>/<type>/<hash>/<quality of service>`. Slashes
//! within a part are written `%`.

use crate::attachment::Gid;
use crate::key::dds_type;
use crate::qos::{Qos, QosError};
use std::fmt;
use std::str::FromStr;
use twox_hash::XxHash3_128;

/// How all tokens begin.
pub const SPACE: &str = "@ros2_lv";
/// What stands for nothing.
const NOTHING: &str = "%";

/// What takes part in a graph.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// The domain.
    pub domain: u32,
    /// The session's id, in hexadecimal digits.
    pub session: String,
    /// Number of the node in its session.
    pub node_id: u64,
    /// Number of what the token is for, in its session; of a node that of the node.
    pub entity_id: u64,
    /// Security enclave; empty for none.
    pub enclave: String,
    /// The node's namespace: `/`, or `/` before each part.
    pub namespace: String,
    /// The node's name.
    pub node: String,
    /// What the node has there; nothing for the node itself.
    pub endpoint: Option<Endpoint>,
}

/// What a node publishes, subscribes to, serves or calls.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Which of these.
    pub kind: EndpointKind,
    /// Whole name of the topic or service.
    pub topic: String,
    /// The type, as DDS has its name.
    pub dds_type: String,
    /// Hash of the type.
    pub hash: String,
    /// Quality of service.
    pub qos: Qos,
}

/// What a node does with a topic or service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndpointKind {
    /// Publishes it.
    Publisher,
    /// Subscribes to it.
    Subscriber,
    /// Serves it.
    Server,
    /// Calls it.
    Client,
}

impl Endpoint {
    /// Of a type that ROS 2 calls `type_name`.
    pub fn new(kind: EndpointKind, topic: &str, type_name: &str, hash: &str, qos: Qos) -> Self {
        Self {
            kind,
            topic: topic.into(),
            dds_type: dds_type(type_name),
            hash: hash.into(),
            qos,
        }
    }
}

/// Why a token could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TokenError {
    /// It has another number of parts, or begins otherwise.
    #[error("liveliness token: {SPACE}, and 9 or 13 parts expected, found {0:?}")]
    Parts(String),
    /// A part is none of what it can be.
    #[error("liveliness token, {part}: {expected} expected, found {actual:?}")]
    Part {
        /// Which one.
        part: &'static str,
        /// What it can be.
        expected: &'static str,
        /// What it is.
        actual: String,
    },
    /// Its quality of service cannot be read.
    #[error("liveliness token, {0}")]
    Qos(#[from] QosError),
}

impl Token {
    /// Who this is in attachments: XXH3 of the token with 128 bits, the low half first.
    pub fn gid(&self) -> Gid {
        XxHash3_128::oneshot(self.to_string().as_bytes()).to_le_bytes()
    }
}

impl EndpointKind {
    fn code(self) -> &'static str {
        match self {
            Self::Publisher => "MP",
            Self::Subscriber => "MS",
            Self::Server => "SS",
            Self::Client => "SC",
        }
    }

    fn of_code(code: &str) -> Option<Self> {
        let all = [
            Self::Publisher,
            Self::Subscriber,
            Self::Server,
            Self::Client,
        ];
        all.into_iter().find(|kind| kind.code() == code)
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            domain,
            session,
            node_id,
            entity_id,
            ..
        } = self;
        let kind = self.endpoint.as_ref().map_or("NN", |e| e.kind.code());
        let [enclave, namespace] = [&self.enclave, &self.namespace].map(|text| mangle(text));
        write!(f, "{SPACE}/{domain}/{session}/{node_id}/{entity_id}/{kind}")?;
        write!(f, "/{enclave}/{namespace}/{}", mangle(&self.node))?;
        if let Some(Endpoint {
            topic,
            dds_type,
            hash,
            qos,
            ..
        }) = &self.endpoint
        {
            write!(f, "/{}/{dds_type}/{hash}/{}", mangle(topic), qos.encode())?;
        }
        Ok(())
    }
}

impl FromStr for Token {
    type Err = TokenError;

    fn from_str(text: &str) -> Result<Self, TokenError> {
        let parts: Vec<&str> = text.split('/').collect();
        let [
            SPACE,
            domain,
            session,
            node_id,
            entity_id,
            kind,
            enclave,
            namespace,
            node,
            rest @ ..,
        ] = &parts[..]
        else {
            return Err(TokenError::Parts(text.into()));
        };
        let wrong = |part, expected, actual: &str| TokenError::Part {
            part,
            expected,
            actual: actual.into(),
        };
        let number = |part, text: &str| text.parse().map_err(|_| wrong(part, "a number", text));
        let endpoint = match (*kind, rest) {
            ("NN", []) => None,
            (code, [topic, dds_type, hash, qos]) => Some(Endpoint {
                kind: EndpointKind::of_code(code)
                    .ok_or_else(|| wrong("kind", "NN, MP, MS, SS or SC", code))?,
                topic: demangle(topic),
                dds_type: (*dds_type).into(),
                hash: (*hash).into(),
                qos: Qos::decode(qos)?,
            }),
            _ => return Err(TokenError::Parts(text.into())),
        };
        let is_id =
            session.bytes().all(|b| b.is_ascii_hexdigit()) && (1..=32).contains(&session.len());
        if !is_id {
            return Err(wrong("session", "up to 32 hexadecimal digits", session));
        }
        Ok(Self {
            domain: domain
                .parse()
                .map_err(|_| wrong("domain", "a number", domain))?,
            session: (*session).into(),
            node_id: number("node id", node_id)?,
            entity_id: number("entity id", entity_id)?,
            enclave: match *enclave {
                NOTHING => String::new(),
                other => demangle(other),
            },
            namespace: demangle(namespace),
            node: demangle(node),
            endpoint,
        })
    }
}

/// Slashes written `%`; nothing as `%`.
fn mangle(text: &str) -> String {
    match text {
        "" => NOTHING.into(),
        other => other.replace('/', "%"),
    }
}

fn demangle(text: &str) -> String {
    text.replace('%', "/")
}
