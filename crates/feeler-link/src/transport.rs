//! Messages over Zenoh. What they say is none of its business.

use super::endpoints::{LinkConfig, LinkError};
use super::linger::{self, Connection};
use super::network::{Heard, Network};
use super::outlet::Outlet;
use super::topic::Topic;
use super::transport_settings::settings;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use zenoh::bytes::Encoding;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::Locality;
use zenoh::{Session, Wait};

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

fn transport(error: zenoh::Error) -> LinkError {
    LinkError::Transport(error.to_string())
}
