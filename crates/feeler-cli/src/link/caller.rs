//! Client that sends orders to a hand over the network.

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

/// Time that the hand may take to obey an order before it is sent again.
pub const INTERVAL: Duration = Duration::from_millis(200);

/// Time that the hand must remain in the requested state before success is reported.
pub const STEADY: Duration = Duration::from_millis(300);

/// A client that sends orders to the hand of a rig.
pub struct Caller {
    network: Arc<dyn Network>,
    inbox: Shared<WatchInbox>,
    _beacon: Arc<Beacon>,
}

impl Caller {
    /// Starts looking for the hand of the rig `name`.
    pub fn new(link: &LinkArguments, name: &str) -> Result<Self, CommandError> {
        Self::over(link.connect(name)?)
    }

    /// Like [`new`](Self::new), but over an existing `network` of the rig.
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

    /// Waits at most `longest` until the hand reports a mode that satisfies `is_so`; returns `true` if it does.
    pub fn hears(&self, longest: Duration, is_so: impl Fn(&HandMode) -> bool) -> bool {
        let heard = |inbox: &mut WatchInbox| inbox.mode().is_some_and(&is_so);
        self.inbox.wait_for(longest, heard)
    }

    /// Returns the mode that the hand reported last.
    pub fn mode(&self) -> HandMode {
        self.inbox.lock().mode().cloned().unwrap_or_default()
    }

    /// Sends `order` repeatedly until the hand's mode satisfies `is_so`, for at most `longest`, then checks that it
    /// remains so.
    pub fn order(
        &self,
        order: &Order,
        longest: Duration,
        is_so: impl Fn(&HandMode) -> bool,
    ) -> Result<Heeded, CommandError> {
        let start = Instant::now();
        // Repeated, because the network may drop a message.
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

/// Result of an order.
pub enum Heeded {
    /// The hand did not confirm the order.
    Not,
    /// The hand obeyed, but left the requested state again.
    Undone,
    /// The hand obeyed and remains in the requested state.
    Steadily,
}
