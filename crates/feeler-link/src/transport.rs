//! Messages over Zenoh. What they say is none of its business.

use super::endpoints::{LinkConfig, LinkError};
use super::linger::{self, Connection};
use super::network::{Heard, Network};
use super::outlet::Outlet;
use super::rights::{Role, access_control};
use super::topic::Topic;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, PoisonError};
use zenoh::bytes::Encoding;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::Locality;
use zenoh::{Config, Session, Wait};

/// A program's place in the link.
#[derive(Clone)]
pub struct Link {
    shared: Arc<Shared>,
}

struct Shared {
    session: Session,
    rig: String,
    publishers: Mutex<HashMap<Topic, Publisher<'static>>>,
    subscribers: Mutex<Vec<Subscriber<()>>>,
}

impl Link {
    /// Takes part in the link as `config` says. Programs that are not there yet are waited for in the
    /// background.
    ///
    /// # Errors
    /// When the configuration makes no sense, or the place to listen is taken.
    pub fn open(config: &LinkConfig) -> Result<Self, LinkError> {
        config.check()?;
        let session = zenoh::open(settings(config)?).wait().map_err(transport)?;
        let shared = Arc::new(Shared {
            session,
            rig: config.rig.clone(),
            publishers: Mutex::default(),
            subscribers: Mutex::default(),
        });
        let link = Self { shared };
        link.keep_linger_off()?;
        Ok(link)
    }

    /// Clears the linger of this session's sockets, of those that there are and of each new one.
    fn keep_linger_off(&self) -> Result<(), LinkError> {
        let session = &self.shared.session;
        // Zenoh tells a session of its own links under this key; no other program hears it.
        let key = format!("@/{}/session/transport/unicast/*/link/*", session.zid());
        let of_new = session
            .declare_subscriber(&key)
            .allowed_origin(Locality::SessionLocal)
            .callback(|sample| clear_linger(&sample.payload().to_bytes()))
            .wait()
            .map_err(transport)?;
        lock(&self.shared.subscribers).push(of_new);
        let clear_known = |reply: zenoh::query::Reply| {
            if let Ok(sample) = reply.result() {
                clear_linger(&sample.payload().to_bytes());
            }
        };
        session
            .get(&key)
            .allowed_destination(Locality::SessionLocal)
            .callback(clear_known)
            .wait()
            .map_err(transport)
    }

    fn publisher(&self, topic: Topic) -> Result<Publisher<'static>, LinkError> {
        // Pictures must not stand in the way of what stops the hand.
        let priority = match topic {
            Topic::Stop => Priority::RealTime,
            Topic::Picture(_) => Priority::DataHigh,
            Topic::Heartbeat => Priority::Data,
            _ => Priority::InteractiveHigh,
        };
        self.shared
            .session
            .declare_publisher(topic.key(&self.shared.rig))
            .encoding(Encoding::APPLICATION_CDR)
            // A program does not hear itself.
            .allowed_destination(Locality::Remote)
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .express(true)
            .wait()
            .map_err(transport)
    }
}

impl Outlet for Link {
    /// Drops what the network cannot take, and never waits for it: older data are worth nothing once there
    /// are newer ones.
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        let mut publishers = lock(&self.shared.publishers);
        let publisher = match publishers.entry(topic) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(self.publisher(topic)?),
        };
        publisher.put(bytes).wait().map_err(transport)
    }
}

impl Network for Link {
    fn listen(&self, topic: Topic, heard: Heard) -> Result<(), LinkError> {
        let subscriber = self
            .shared
            .session
            .declare_subscriber(topic.key(&self.shared.rig))
            .callback(move |sample| heard(topic, &sample.payload().to_bytes()))
            .wait()
            .map_err(transport)?;
        lock(&self.shared.subscribers).push(subscriber);
        Ok(())
    }
}

/// Clears the linger of the socket of a link that Zenoh describes; nothing if the link is gone.
fn clear_linger(link: &[u8]) {
    if let Some(connection) = Connection::of_link(link) {
        // Where the system does not allow it, closing a frozen peer takes ten seconds; all else works.
        let _ = linger::clear(connection);
    }
}

fn settings(config: &LinkConfig) -> Result<Config, LinkError> {
    let mut settings = Config::default();
    let mut set = |key: &str, value: serde_json::Value| {
        let set = settings.insert_json5(key, &value.to_string());
        set.map_err(|e| LinkError::Transport(format!("{key}: {e}")))
    };
    set("mode", "peer".into())?;
    set("listen/endpoints", config.listen.clone().into())?;
    set("connect/endpoints", config.connect.clone().into())?;
    // Whoever is not there yet is tried for ever, and that holds up nobody.
    set("connect/timeout_ms", (-1).into())?;
    set("connect/exit_on_failure", false.into())?;
    set(
        "connect/retry",
        serde_json::json!({
            "period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 1.5
        }),
    )?;
    set("listen/exit_on_failure", true.into())?;
    // Only endpoints that were named are listened to or connected to, and those that they tell of.
    set("scouting/multicast/enabled", false.into())?;
    set("scouting/gossip/enabled", true.into())?;
    // Of two programs that learn of each other, one connects, not both; one that nobody can connect to
    // connects to all.
    let connects = if config.listen.is_empty() {
        "always"
    } else {
        "greater-zid"
    };
    set(
        "scouting/gossip/autoconnect_strategy",
        serde_json::json!({"peer": {"to_peer": connects}}),
    )?;
    // With the two places that are the default, half of what comes in a burst would be dropped.
    for priority in ["real_time", "interactive_high", "data_high", "data"] {
        set(
            &format!("transport/link/tx/queue/size/{priority}"),
            16.into(),
        )?;
    }
    // Nobody waits for a program that is frozen and does not read. A picture larger than the queue needs a moment
    // until its first pieces have left.
    let drop = "transport/link/tx/queue/congestion_control/drop";
    set(&format!("{drop}/wait_before_drop"), 0.into())?;
    set(
        &format!("{drop}/max_wait_before_drop_fragments"),
        5000.into(),
    )?;
    // A cable that is cut longer closes the link, so that no old data come in a burst afterwards.
    set("transport/link/tx/lease", 1000.into())?;
    let most = Topic::Picture(0).most_bytes();
    set("transport/link/rx/max_message_size", most.into())?;
    set("timestamping/enabled", false.into())?;
    set("adminspace/enabled", false.into())?;
    if let Some([ca, certificate, key]) = config.certificate_files() {
        let path = |path: &std::path::Path| path.display().to_string();
        set("transport/link/tls/root_ca_certificate", path(&ca).into())?;
        set("transport/link/tls/enable_mtls", true.into())?;
        set("transport/link/tls/close_link_on_expiration", true.into())?;
        for side in ["listen", "connect"] {
            set(
                &format!("transport/link/tls/{side}_certificate"),
                path(&certificate).into(),
            )?;
            set(
                &format!("transport/link/tls/{side}_private_key"),
                path(&key).into(),
            )?;
        }
    }
    let role = match config.listen.is_empty() {
        false => Role::Hand,
        true => Role::Member,
    };
    if let Some(rules) = access_control(config, role)? {
        set("access_control", rules)?;
    }
    Ok(settings)
}

fn transport(error: zenoh::Error) -> LinkError {
    LinkError::Transport(error.to_string())
}

/// A panic elsewhere does not lock the link for good.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
