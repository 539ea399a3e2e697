//! A hand that somebody gives an order to, over the link.

use super::LinkArguments;
use super::orders::Order;
use crate::CommandError;
use feeler_link::beacon::Beacon;
use feeler_link::inbox::listen;
use feeler_link::message::{HandMode, Heartbeat, NO_FINGER, ProgramKind};
use feeler_link::network::Network;
use feeler_link::outlet::{draw_instance, monotonic};
use feeler_link::shared::Shared;
use feeler_link::topic::Topic;
use feeler_link::watch_inbox::WatchInbox;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long the hand may take to heed an order before it is said again.
pub const INTERVAL: Duration = Duration::from_millis(200);

/// How long the hand must stay as it was told before that is reported.
pub const STEADY: Duration = Duration::from_millis(300);

/// A hand that somebody gives an order to.
pub struct Caller {
    network: Arc<dyn Network>,
    inbox: Shared<WatchInbox>,
    _beacon: Arc<Beacon>,
}

impl Caller {
    /// Begins to look for the hand of the rig `name`.
    pub fn new(link: &LinkArguments, name: &str) -> Result<Self, CommandError> {
        Self::over(link.connect(name)?)
    }

    /// The same of the rig that `network` is of.
    pub fn over(network: Arc<dyn Network>) -> Result<Self, CommandError> {
        let heartbeat = Heartbeat {
            instance: draw_instance(),
            program: ProgramKind::Order,
            finger: NO_FINGER,
            age: f64::NAN,
            ..Heartbeat::default()
        };
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let inbox = Shared::new(WatchInbox::new(&[], Vec::new()));
        let topics: Vec<Topic> = Topic::heartbeats().chain([Topic::Mode]).collect();
        listen(&*network, &topics, &inbox, &monotonic(), &beacon)?;
        Ok(Self {
            network,
            inbox,
            _beacon: beacon,
        })
    }

    /// Whether the hand says within `longest` that it is as `is_so` asks.
    pub fn hears(&self, longest: Duration, is_so: impl Fn(&HandMode) -> bool) -> bool {
        let heard = |inbox: &mut WatchInbox| inbox.mode().is_some_and(&is_so);
        self.inbox.wait_for(longest, heard)
    }

    /// What the hand said last.
    pub fn mode(&self) -> HandMode {
        self.inbox.lock().mode().cloned().unwrap_or_default()
    }

    /// Says `order` until the hand is as `is_so` asks, for at most `longest`, and whether it then stays so.
    pub fn order(
        &self,
        order: &Order,
        longest: Duration,
        is_so: impl Fn(&HandMode) -> bool,
    ) -> Result<Heeded, CommandError> {
        let start = Instant::now();
        // More than once: a message that the network cannot take is dropped.
        while start.elapsed() < longest {
            order.send(&*self.network)?;
            if self.hears(INTERVAL, &is_so) {
                return Ok(match self.hears(STEADY, |mode| !is_so(mode)) {
                    true => Heeded::Undone,
                    false => Heeded::Steadily,
                });
            }
        }
        Ok(Heeded::Not)
    }
}

/// What came of an order.
pub enum Heeded {
    /// The hand did not say that it does so.
    Not,
    /// It did, and no longer does.
    Undone,
    /// It does.
    Steadily,
}
