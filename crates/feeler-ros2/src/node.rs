//! A node of a ROS 2 graph over Zenoh.

use crate::attachment::Attachment;
use crate::key::key;
use crate::name::{NameError, NodeName};
use crate::publisher::Publisher;
use crate::qos::Qos;
use crate::server::{Answer, Server};
use crate::token::{Endpoint, EndpointKind, Token};
use crate::type_description::{DescriptionError, Service, TypeDescription};
use feeler_record::wire::{Message, WireError};
use std::time::{SystemTime, UNIX_EPOCH};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::{Config, Session, Wait};

/// Where `rmw_zenohd`, the router of ROS 2, listens.
pub const ROUTER_ENDPOINT: &str = "tcp/localhost:7447";
/// Where a node listens for others of its graph: at a port that the system chooses.
pub const NODE_ENDPOINT: &str = "tcp/localhost:0";

/// How a node takes part in its graph.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeConfig {
    /// Its name.
    pub name: NodeName,
    /// Where routers or other nodes are, as Zenoh writes places; tried for ever. One that is not there holds up nobody.
    pub connect: Vec<String>,
    /// Where to listen for others.
    pub listen: Vec<String>,
}

/// Why a node cannot do its work.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// A name makes no sense.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A message text makes no sense.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// A message cannot be encoded.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// Zenoh refuses.
    #[error("ROS 2 graph: {0}")]
    Zenoh(String),
    /// A thread cannot be started.
    #[error("a thread for a service: {0}")]
    Thread(#[from] std::io::Error),
}

impl From<zenoh::Error> for NodeError {
    fn from(error: zenoh::Error) -> Self {
        Self::Zenoh(error.to_string())
    }
}

/// A node. What it publishes and serves ends with it.
pub struct Node {
    session: Session,
    name: NodeName,
    /// Number of what comes next.
    next_id: u64,
    _token: LivelinessToken,
    servers: Vec<Server>,
}

/// A topic that is subscribed to, for as long as this is kept.
pub struct Subscription {
    _subscriber: Subscriber<()>,
    _token: LivelinessToken,
}

impl Node {
    /// Becomes part of a graph.
    ///
    /// # Errors
    /// When there is no such place to listen, or a place makes no sense.
    pub fn open(config: NodeConfig) -> Result<Self, NodeError> {
        let session = zenoh::open(settings(&config)?).wait()?;
        let token = Token {
            domain: config.name.domain(),
            session: session.zid().to_string(),
            node_id: 0,
            entity_id: 0,
            enclave: String::new(),
            namespace: config.name.namespace().into(),
            node: config.name.name().into(),
            endpoint: None,
        };
        let token = session
            .liveliness()
            .declare_token(token.to_string())
            .wait()?;
        Ok(Self {
            session,
            name: config.name,
            next_id: 1,
            _token: token,
            servers: Vec::new(),
        })
    }

    /// Its name.
    pub fn name(&self) -> &NodeName {
        &self.name
    }

    /// Whether a router or another node of the graph is connected.
    pub fn has_company(&self) -> bool {
        let info = self.session.info();
        let router = info.routers_zid().wait().next();
        router.or_else(|| info.peers_zid().wait().next()).is_some()
    }

    /// The key of a topic or service, and the token of a new endpoint of it.
    fn endpoint(
        &mut self,
        kind: EndpointKind,
        topic: &str,
        (type_name, hash): (&str, &str),
        qos: Qos,
    ) -> Result<(String, Token), NodeError> {
        let topic = self.name.resolve(topic)?;
        let token = Token {
            domain: self.name.domain(),
            session: self.session.zid().to_string(),
            node_id: 0,
            entity_id: self.next_id,
            enclave: String::new(),
            namespace: self.name.namespace().into(),
            node: self.name.name().into(),
            endpoint: Some(Endpoint::new(kind, &topic, type_name, hash, qos)),
        };
        self.next_id += 1;
        Ok((key(self.name.domain(), &topic, type_name, hash), token))
    }

    /// Publishes `topic`, which is resolved as [`NodeName::resolve`] says.
    ///
    /// # Errors
    /// When it is no name of a topic, or the session is closed.
    pub fn publish<M: Message>(
        &mut self,
        topic: &str,
        qos: Qos,
    ) -> Result<Publisher<M>, NodeError> {
        let hash = TypeDescription::of_message::<M>()?.hash();
        let of_type = (M::SCHEMA_NAME, hash.as_str());
        let (key, token) = self.endpoint(EndpointKind::Publisher, topic, of_type, qos)?;
        Publisher::declare(&self.session, key, &token, qos)
    }

    /// Subscribes to `topic`. `heard` is called with each message's bytes and what stands beside them, on Zenoh's thread, which it must not
    /// hold up. A message with nothing beside it, or something else, is none of a node, and is left.
    ///
    /// # Errors
    /// When it is no name of a topic, or the session is closed.
    pub fn subscribe<M: Message>(
        &mut self,
        topic: &str,
        qos: Qos,
        heard: impl Fn(&[u8], Attachment) + Send + Sync + 'static,
    ) -> Result<Subscription, NodeError> {
        let hash = TypeDescription::of_message::<M>()?.hash();
        let of_type = (M::SCHEMA_NAME, hash.as_str());
        let (key, token) = self.endpoint(EndpointKind::Subscriber, topic, of_type, qos)?;
        let callback = move |sample: zenoh::sample::Sample| {
            let beside = sample
                .attachment()
                .map(|bytes| Attachment::decode(&bytes.to_bytes()));
            if let Some(Ok(attachment)) = beside {
                heard(&sample.payload().to_bytes(), attachment);
            }
        };
        Ok(Subscription {
            _subscriber: self
                .session
                .declare_subscriber(key)
                .callback(callback)
                .wait()?,
            _token: self
                .session
                .liveliness()
                .declare_token(token.to_string())
                .wait()?,
        })
    }

    /// Serves `service`, by a thread of its own that calls `answer` with one request after the other.
    ///
    /// # Errors
    /// When it is no name of a service, or the session is closed.
    pub fn serve<S: Service>(
        &mut self,
        service: &str,
        answer: impl Answer<S>,
    ) -> Result<(), NodeError> {
        let hash = TypeDescription::of_service::<S>()?.hash();
        let (key, token) = self.endpoint(
            EndpointKind::Server,
            service,
            (S::NAME, &hash),
            Qos::DEFAULT,
        )?;
        let server = Server::declare::<S>(&self.session, key, &token, answer)?;
        self.servers.push(server);
        Ok(())
    }
}

/// The time, ns since 1970.
pub(crate) fn wall_clock_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
    })
}

/// A session as those of `rmw_zenoh`: it finds its graph by a router, and then talks to each node itself.
fn settings(config: &NodeConfig) -> Result<Config, NodeError> {
    let mut settings = Config::default();
    let places = |places: &[String]| serde_json::json!(places).to_string();
    for (key, value) in [
        ("mode", "\"peer\"".into()),
        ("connect/endpoints", places(&config.connect)),
        ("connect/timeout_ms", "-1".into()),
        ("connect/exit_on_failure", "false".into()),
        ("listen/endpoints", places(&config.listen)),
        ("listen/exit_on_failure", "true".into()),
        ("scouting/multicast/enabled", "false".into()),
        ("scouting/gossip/enabled", "true".into()),
        // Who comes late is answered by time.
        ("timestamping/enabled", "true".into()),
        ("adminspace/enabled", "false".into()),
    ] {
        settings
            .insert_json5(key, &value)
            .map_err(|e| NodeError::Zenoh(format!("{key}: {e}")))?;
    }
    Ok(settings)
}
