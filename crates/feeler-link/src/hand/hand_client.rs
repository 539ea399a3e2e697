//! Client that sends orders to a hand and waits for their effect.

use crate::hand::order::Order;
use crate::inboxes::beacon::Beacon;
use crate::inboxes::inbox::listen;
use crate::inboxes::watch_inbox::WatchInbox;
use crate::messages::joints::JointCounts;
use crate::messages::message::{HandMode, Heartbeat, NO_FINGER, ProgramKind};
use crate::transport::endpoints::LinkError;
use crate::transport::network::Network;
use crate::transport::outlet::{draw_instance, monotonic};
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Interval at which an order is repeated until the hand obeys.
pub const INTERVAL: Duration = Duration::from_millis(200);

/// Time for which the requested state must last before it is reported as stable.
pub const STEADY: Duration = Duration::from_millis(300);

/// Client that sends orders to the hand of a rig and observes its mode.
pub struct HandClient {
    network: Arc<dyn Network>,
    inbox: Shared<WatchInbox>,
    _beacon: Arc<Beacon>,
}

impl HandClient {
    /// Starts to receive messages of the hand of the rig that `network` connects.
    ///
    /// # Errors
    /// If the network refuses to send or listen.
    pub fn new(network: Arc<dyn Network>) -> Result<Self, LinkError> {
        let heartbeat = Heartbeat {
            instance: draw_instance(),
            program: ProgramKind::Order,
            finger: NO_FINGER,
            age: f64::NAN,
            ..Heartbeat::default()
        };
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let inbox = Shared::new(WatchInbox::new(&[], Vec::new(), JointCounts::default()));
        let topics: Vec<Topic> = Topic::heartbeats().chain([Topic::Mode]).collect();
        listen(&*network, &topics, &inbox, &monotonic(), &beacon)?;
        Ok(Self {
            network,
            inbox,
            _beacon: beacon,
        })
    }

    /// Waits up to `longest` for the hand to report a mode that satisfies `is_so`; returns whether it did.
    pub fn wait_until(&self, longest: Duration, is_so: impl Fn(&HandMode) -> bool) -> bool {
        let heard = |inbox: &mut WatchInbox| inbox.mode().is_some_and(&is_so);
        self.inbox.wait_for(longest, heard)
    }

    /// Mode last reported by the hand; the default mode before its first report.
    pub fn mode(&self) -> HandMode {
        self.inbox.lock().mode().cloned().unwrap_or_default()
    }

    /// Repeats `order` for at most `longest`, until the hand's mode satisfies `is_so`, then checks that the mode
    /// continues to do so.
    ///
    /// # Errors
    /// If the network refuses the message.
    pub fn order(
        &self,
        order: &Order,
        longest: Duration,
        is_so: impl Fn(&HandMode) -> bool,
    ) -> Result<Ack, LinkError> {
        let start = Instant::now();
        // Repeated, since the network drops messages when it is congested.
        while start.elapsed() < longest {
            order.send(&*self.network)?;
            if self.wait_until(INTERVAL, &is_so) {
                return Ok(match self.wait_until(STEADY, |mode| !is_so(mode)) {
                    true => Ack::Reverted,
                    false => Ack::Stable,
                });
            }
        }
        Ok(Ack::None)
    }
}

/// Response of a hand to an order.
pub enum Ack {
    /// The hand did not report the requested state.
    None,
    /// The hand reported the requested state, then left it.
    Reverted,
    /// The hand reported the requested state and stayed in it.
    Stable,
}
