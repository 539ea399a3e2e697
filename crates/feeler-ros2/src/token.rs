//! Liveliness tokens, by which nodes of a graph discover each other.
//!
//! The token of a node is `@ros2_lv/<domain>/<session>/<node id>/<node id>/NN/<enclave>/<namespace>/<name>`. The token
//! of an endpoint (publisher, subscriber, server or client) contains its entity id instead of the second node id and
//! its kind instead of `NN`, followed by `/<topic>/<type>/<hash>/<quality of service>`. Slashes within a part are
//! replaced by `%`.

use crate::attachment::Gid;
use crate::key::dds_type;
use crate::qos::Qos;
use std::fmt;
use twox_hash::XxHash3_128;

/// First part of all tokens.
pub const SPACE: &str = "@ros2_lv";
/// Encoding of an empty part.
const NOTHING: &str = "%";

/// Liveliness token of a node or an endpoint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// Domain id.
    pub domain: u32,
    /// Zenoh session id (hexadecimal).
    pub session: String,
    /// Identifier of the node in its session.
    pub node_id: u64,
    /// Identifier of the endpoint in its session; equal to `node_id` in the token of a node.
    pub entity_id: u64,
    /// Security enclave; may be empty.
    pub enclave: String,
    /// Namespace of the node, such as `/` or `/lab/left`.
    pub namespace: String,
    /// Name of the node.
    pub node: String,
    /// Endpoint, or `None` for the token of a node.
    pub endpoint: Option<Endpoint>,
}

/// Publisher, subscriber, server or client of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Kind of the endpoint.
    pub kind: EndpointKind,
    /// Absolute name of the topic or service.
    pub topic: String,
    /// DDS name of the type.
    pub dds_type: String,
    /// Hash of the type.
    pub hash: String,
    /// Quality of service.
    pub qos: Qos,
}

/// Kind of an endpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndpointKind {
    /// Publisher of a topic.
    Publisher,
    /// Subscriber to a topic.
    Subscriber,
    /// Server of a service.
    Server,
    /// Client of a service.
    Client,
}

impl Endpoint {
    /// Creates an endpoint. `type_name` is the ROS 2 name of its type, such as `sensor_msgs/msg/JointState`.
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

impl Token {
    /// Returns the source identifier for attachments: the 128-bit XXH3 hash of the token, little-endian.
    pub fn gid(&self) -> Gid {
        XxHash3_128::oneshot(self.to_string().as_bytes()).to_le_bytes()
    }

    /// Announces the node or endpoint until the returned token is dropped.
    #[cfg(feature = "zenoh")]
    pub(crate) fn declare(
        &self,
        session: &zenoh::Session,
    ) -> zenoh::Result<zenoh::liveliness::LivelinessToken> {
        use zenoh::Wait;
        session.liveliness().declare_token(self.to_string()).wait()
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

/// Encodes a part: replaces slashes by `%`, and an empty text by `%`.
fn mangle(text: &str) -> String {
    match text {
        "" => NOTHING.into(),
        other => other.replace('/', "%"),
    }
}
