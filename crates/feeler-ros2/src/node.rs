//! ROS 2 nodes over Zenoh.

use crate::attachment::Attachment;
use crate::client::Client;
use crate::key::key;
use crate::name::NodeName;
use crate::node_error::NodeError;
use crate::publisher::Publisher;
use crate::qos::Qos;
use crate::server::{Answer, Server};
use crate::token::{Endpoint, EndpointKind, Token};
use crate::type_description::{Service, TypeDescription};
use feeler_record::wire::Message;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::{Config, Session, Wait};

/// Default endpoint of `rmw_zenohd`, the router of ROS 2.
pub const ROUTER_ENDPOINT: &str = "tcp/localhost:7447";
/// Default endpoint on which a node listens for other nodes; the system chooses the port.
pub const NODE_ENDPOINT: &str = "tcp/localhost:0";

/// Configuration of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeConfig {
    /// Domain, namespace and name.
    pub name: NodeName,
    /// Endpoints of routers or other nodes, in Zenoh's notation. Failed connections are retried indefinitely in the
    /// background.
    pub connect: Vec<String>,
    /// Endpoints to listen on.
    pub listen: Vec<String>,
}

/// A node of a ROS 2 graph. Dropping it ends its services.
pub struct Node {
    session: Session,
    name: NodeName,
    /// Entity id of the next endpoint.
    next_id: u64,
    _token: LivelinessToken,
    servers: Vec<Server>,
}

/// Subscription to a topic. Dropping it unsubscribes.
pub struct Subscription {
    _subscriber: Subscriber<()>,
    _token: LivelinessToken,
}

impl Node {
    /// Opens a Zenoh session and announces the node. Does not wait for connections.
    ///
    /// # Errors
    /// If an endpoint is invalid, or listening on it fails.
    pub fn open(config: NodeConfig) -> Result<Self, NodeError> {
        let session = zenoh::open(settings(&config)?).wait()?;
        let token = token(&session, &config.name, 0, None);
        Ok(Self {
            _token: token.declare(&session)?,
            session,
            name: config.name,
            next_id: 1,
            servers: Vec::new(),
        })
    }

    /// Name of the node.
    pub fn name(&self) -> &NodeName {
        &self.name
    }

    /// Returns `true` if a router or another node is connected.
    pub fn has_company(&self) -> bool {
        let info = self.session.info();
        let router = info.routers_zid().wait().next();
        router.or_else(|| info.peers_zid().wait().next()).is_some()
    }

    /// Returns the key and the token of a new endpoint of a topic or service.
    fn endpoint(
        &mut self,
        kind: EndpointKind,
        topic: &str,
        (type_name, hash): (&str, &str),
        qos: Qos,
    ) -> Result<(String, Token), NodeError> {
        let topic = self.name.resolve(topic)?;
        let endpoint = Endpoint::new(kind, &topic, type_name, hash, qos);
        let token = token(&self.session, &self.name, self.next_id, Some(endpoint));
        self.next_id += 1;
        Ok((key(self.name.domain(), &topic, type_name, hash), token))
    }

    /// Creates a publisher of `topic`, whose name is resolved with [`NodeName::resolve`].
    ///
    /// # Errors
    /// If `topic` is not a valid name, or the session is closed.
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

    /// Subscribes to `topic`, whose name is resolved with [`NodeName::resolve`]. The callback receives the bytes and
    /// attachment of each message. It is called on Zenoh's thread, so it must not block. Messages without a valid
    /// attachment are not from a ROS 2 node, and are ignored.
    ///
    /// # Errors
    /// If `topic` is not a valid name, or the session is closed.
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
            _token: token.declare(&self.session)?,
        })
    }

    /// Serves `service`, whose name is resolved with [`NodeName::resolve`]. A dedicated thread calls `answer` for one
    /// request at a time.
    ///
    /// # Errors
    /// If `service` is not a valid name, the session is closed, or the thread cannot be started.
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

    /// Creates a client of `service`, whose name is resolved with [`NodeName::resolve`]. Does not wait for its server.
    ///
    /// # Errors
    /// If `service` is not a valid name, or the session is closed.
    pub fn client<S: Service>(&mut self, service: &str) -> Result<Client<S>, NodeError> {
        let hash = TypeDescription::of_service::<S>()?.hash();
        let of_type = (S::NAME, hash.as_str());
        let (key, token) = self.endpoint(EndpointKind::Client, service, of_type, Qos::DEFAULT)?;
        Client::declare(&self.session, key, &token)
    }
}

/// Returns the token of the node `name`, the only one of `session`, or of its endpoint number `entity_id`.
fn token(session: &Session, name: &NodeName, entity_id: u64, endpoint: Option<Endpoint>) -> Token {
    Token {
        domain: name.domain(),
        session: session.zid().to_string(),
        node_id: 0,
        entity_id,
        enclave: String::new(),
        namespace: name.namespace().into(),
        node: name.name().into(),
        endpoint,
    }
}

/// Returns the Zenoh configuration of a node. As with `rmw_zenoh`, a node discovers others through a router, and then
/// connects to them directly.
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
        // Required by caches for late subscribers.
        ("timestamping/enabled", "true".into()),
        ("adminspace/enabled", "false".into()),
    ] {
        settings
            .insert_json5(key, &value)
            .map_err(|e| NodeError::Zenoh(format!("{key}: {e}")))?;
    }
    Ok(settings)
}
