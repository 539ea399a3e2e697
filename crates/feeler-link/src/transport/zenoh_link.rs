//! Transport of encoded messages over Zenoh.

use super::endpoints::{LinkConfig, LinkError};
use super::linger::{self, Connection};
use super::network::{MessageHandler, Network};
use super::outlet::Outlet;
use super::topic::Topic;
use super::zenoh_settings::settings;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use zenoh::bytes::Encoding;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::Locality;
use zenoh::{Session, Wait};

/// Connection of a program to the link. All messages pass through the hand, which is the only router.
#[derive(Clone)]
pub struct Link {
    rig: Arc<str>,
    state: Arc<Mutex<State>>,
}

enum State {
    /// Waiting for the hand, with the subscriptions to make once connected.
    Opening(Vec<(Topic, MessageHandler)>),
    Open(Box<Open>),
    /// The link could not be opened; contains the reason.
    Failed(String),
}

struct Open {
    session: Session,
    publishers: HashMap<Topic, Publisher<'static>>,
    subscribers: Vec<Subscriber<()>>,
}

impl Link {
    /// Joins the link. The hand listens; any other program connects to the hand in the background, retrying until it
    /// is reachable.
    ///
    /// # Errors
    /// If the configuration is invalid, or the hand cannot listen on its endpoint.
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
        // A Zenoh client blocks here until it finds a router.
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

    /// Makes the subscriptions requested while the link was opening.
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

    /// Locks the state, ignoring poisoning by a panic of another thread.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Open {
    /// Clears the linger option of this session's sockets, existing and new.
    fn keep_linger_off(&mut self) -> Result<(), LinkError> {
        let session = &self.session;
        // Zenoh reports a session's links under this key, to that session only.
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

    fn listen(
        &mut self,
        key: String,
        topic: Topic,
        heard: MessageHandler,
    ) -> Result<(), LinkError> {
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
        // Images must not delay stop orders.
        let priority = match topic {
            Topic::Stop => Priority::RealTime,
            Topic::Picture(_) => Priority::DataHigh,
            Topic::Heartbeat(_) => Priority::Data,
            _ => Priority::InteractiveHigh,
        };
        self.session
            .declare_publisher(key)
            .encoding(Encoding::APPLICATION_CDR)
            // A program does not receive its own messages.
            .allowed_destination(Locality::Remote)
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .express(true)
            .wait()
            .map_err(transport)
    }
}

impl Outlet for Link {
    /// Sends a message without blocking: drops a message that the network cannot accept, because newer data replaces
    /// it.
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
    fn listen(&self, topic: Topic, heard: MessageHandler) -> Result<(), LinkError> {
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

/// Clears the linger option of the socket of a link described by Zenoh. Does nothing if the link no longer exists.
fn clear_linger(link: &[u8]) {
    if let Some(connection) = Connection::of_link(link) {
        // If the system forbids it, closing a frozen peer takes ten seconds; all else works.
        let _ = linger::clear(connection);
    }
}

fn transport(error: zenoh::Error) -> LinkError {
    LinkError::Transport(error.to_string())
}
