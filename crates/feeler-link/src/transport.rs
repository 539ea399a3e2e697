//! Messages over Zenoh. What they say is none of its business.

use super::endpoints::{LinkConfig, LinkError};
use super::linger::{self, Connection};
use super::network::{Heard, Network};
use super::outlet::Outlet;
use super::rights::{Role, access_control};
use super::topic::Topic;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use zenoh::bytes::Encoding;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::Locality;
use zenoh::{Config, Session, Wait};

/// A program's place in the link. All messages pass the hand, which alone listens.
#[derive(Clone)]
pub struct Link {
    rig: Arc<str>,
    state: Arc<Mutex<State>>,
}

enum State {
    /// The hand is not there yet; who wants to hear of what.
    Opening(Vec<(Topic, Heard)>),
    Open(Box<Open>),
    /// It cannot be opened, and why.
    Failed(String),
}

struct Open {
    session: Session,
    publishers: HashMap<Topic, Publisher<'static>>,
    subscribers: Vec<Subscriber<()>>,
}

impl Link {
    /// Takes part in the link as `config` says: listens, or looks for the hand in the background for as long as it
    /// is not there.
    ///
    /// # Errors
    /// When the configuration makes no sense, or the place to listen is taken.
    pub fn open(config: &LinkConfig) -> Result<Self, LinkError> {
        config.check()?;
        let settings = settings(config)?;
        let link = Self {
            rig: config.rig.as_str().into(),
            state: Arc::new(Mutex::new(State::Opening(Vec::new()))),
        };
        if config.is_hand {
            let session = zenoh::open(settings).wait().map_err(transport)?;
            link.begin(session)?;
            return Ok(link);
        }
        let opening = link.clone();
        // Zenoh's client waits in there for the first router.
        let work = move || {
            let opened = zenoh::open(settings).wait().map_err(transport);
            if let Err(error) = opened.and_then(|session| opening.begin(session)) {
                *opening.lock() = State::Failed(error.to_string());
            }
        };
        let thread = thread::Builder::new().name("link".into()).spawn(work);
        thread.map_err(|e| LinkError::Transport(e.to_string()))?;
        Ok(link)
    }

    /// Takes up what was asked for while the link was being opened.
    fn begin(&self, session: Session) -> Result<(), LinkError> {
        let mut state = self.lock();
        let mut open = Open {
            session,
            publishers: HashMap::new(),
            subscribers: Vec::new(),
        };
        open.keep_linger_off()?;
        if let State::Opening(wanted) = &mut *state {
            for (topic, heard) in wanted.drain(..) {
                open.listen(topic.key(&self.rig), topic, heard)?;
            }
        }
        *state = State::Open(Box::new(open));
        Ok(())
    }

    /// A panic elsewhere does not lock the link for good.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Open {
    /// Clears the linger of this session's sockets, of those that there are and of each new one.
    fn keep_linger_off(&mut self) -> Result<(), LinkError> {
        let session = &self.session;
        // Zenoh tells a session of its own links under this key; no other program hears it.
        let key = format!("@/{}/session/transport/unicast/*/link/*", session.zid());
        let of_new = session
            .declare_subscriber(&key)
            .allowed_origin(Locality::SessionLocal)
            .callback(|sample| clear_linger(&sample.payload().to_bytes()))
            .wait()
            .map_err(transport)?;
        let clear_known = |reply: zenoh::query::Reply| {
            if let Ok(sample) = reply.result() {
                clear_linger(&sample.payload().to_bytes());
            }
        };
        let known = session
            .get(&key)
            .allowed_destination(Locality::SessionLocal)
            .callback(clear_known);
        known.wait().map_err(transport)?;
        self.subscribers.push(of_new);
        Ok(())
    }

    fn listen(&mut self, key: String, topic: Topic, heard: Heard) -> Result<(), LinkError> {
        let subscriber = self
            .session
            .declare_subscriber(key)
            .callback(move |sample| heard(topic, &sample.payload().to_bytes()))
            .wait()
            .map_err(transport)?;
        self.subscribers.push(subscriber);
        Ok(())
    }

    fn publisher(&self, key: String, topic: Topic) -> Result<Publisher<'static>, LinkError> {
        // Pictures must not stand in the way of what stops the hand.
        let priority = match topic {
            Topic::Stop => Priority::RealTime,
            Topic::Picture(_) => Priority::DataHigh,
            Topic::Heartbeat(_) => Priority::Data,
            _ => Priority::InteractiveHigh,
        };
        self.session
            .declare_publisher(key)
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
        let mut state = self.lock();
        let open = match &mut *state {
            State::Opening(_) => return Ok(()),
            State::Failed(reason) => return Err(LinkError::Transport(reason.clone())),
            State::Open(open) => open,
        };
        if !open.publishers.contains_key(&topic) {
            let publisher = open.publisher(topic.key(&self.rig), topic)?;
            open.publishers.insert(topic, publisher);
        }
        match open.publishers.get(&topic) {
            Some(publisher) => publisher.put(bytes).wait().map_err(transport),
            None => Ok(()),
        }
    }
}

impl Network for Link {
    fn listen(&self, topic: Topic, heard: Heard) -> Result<(), LinkError> {
        match &mut *self.lock() {
            State::Opening(wanted) => {
                wanted.push((topic, heard));
                Ok(())
            }
            State::Open(open) => open.listen(topic.key(&self.rig), topic, heard),
            State::Failed(reason) => Err(LinkError::Transport(reason.clone())),
        }
    }
}

/// Clears the linger of the socket of a link that Zenoh describes; nothing if the link is gone.
fn clear_linger(link: &[u8]) {
    if let Some(connection) = Connection::of_link(link) {
        // Where the system does not allow it, closing a frozen peer takes ten seconds; all else works.
        let _ = linger::clear(connection);
    }
}

/// How long who connects may take to say who he is, ms.
const PATIENCE_MS: u64 = 2000;

/// `endpoint` with that patience for handshakes of TLS.
fn patient(endpoint: &str) -> String {
    match endpoint.starts_with("tls/") {
        true => format!("{endpoint}#tls_handshake_timeout_ms={PATIENCE_MS}"),
        false => endpoint.into(),
    }
}

fn settings(config: &LinkConfig) -> Result<Config, LinkError> {
    let mut settings = Config::default();
    let mut set = |key: &str, value: serde_json::Value| {
        let set = settings.insert_json5(key, &value.to_string());
        set.map_err(|e| LinkError::Transport(format!("{key}: {e}")))
    };
    // A router passes on what its clients publish. Clients reach it alone, and nobody reaches them.
    set(
        "mode",
        if config.is_hand { "router" } else { "client" }.into(),
    )?;
    let listen = config.listen.iter().map(|endpoint| patient(endpoint));
    set("listen/endpoints", listen.collect::<Vec<_>>().into())?;
    // Who connects and says nothing soon makes room for others, and there is room for many.
    set("transport/unicast/accept_timeout", PATIENCE_MS.into())?;
    set("transport/unicast/accept_pending", 1000.into())?;
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
    // Only endpoints that were named are listened to or connected to.
    set("scouting/multicast/enabled", false.into())?;
    set("scouting/gossip/enabled", false.into())?;
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
    let role = match config.is_hand {
        true => Role::Hand,
        false => Role::Member,
    };
    if let Some(rules) = access_control(config, role)? {
        set("access_control", rules)?;
    }
    Ok(settings)
}

fn transport(error: zenoh::Error) -> LinkError {
    LinkError::Transport(error.to_string())
}
