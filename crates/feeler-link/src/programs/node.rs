//! Network connection of a program, common to all programs of a rig.

use super::error::Warn;
use super::refusals::Refusals;
use crate::inboxes::beacon::Beacon;
use crate::inboxes::inbox::{Inbox, listen};
use crate::messages::message::{Heartbeat, NO_FINGER, ProgramKind};
use crate::messages::mismatch::Mismatch;
use crate::transport::endpoints::LinkError;
use crate::transport::network::Network;
use crate::transport::outlet::{TimeSource, draw_instance, monotonic, send};
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use feeler_record::wire::Message;
use std::sync::Arc;

/// Program on the network, with inbox, heartbeat and clock.
pub(super) struct Node<I> {
    pub network: Arc<dyn Network>,
    pub inbox: Shared<I>,
    pub beacon: Arc<Beacon>,
    pub clock: TimeSource,
    /// Random number that the program drew at its start.
    pub instance: u64,
    refusals: Refusals,
    warn: Warn,
}

impl<I: Inbox + Send + 'static> Node<I> {
    /// Starts sending `heartbeat`, and receives all heartbeats and the messages of `topics` in `inbox`.
    pub fn start(
        network: Arc<dyn Network>,
        heartbeat: Heartbeat,
        inbox: I,
        topics: &[Topic],
    ) -> Result<Self, LinkError> {
        let (inbox, clock, instance) = (Shared::new(inbox), monotonic(), heartbeat.instance);
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let topics: Vec<Topic> = Topic::heartbeats().chain(topics.iter().copied()).collect();
        listen(&*network, &topics, &inbox, &clock, &beacon)?;
        Ok(Self {
            network,
            inbox,
            beacon,
            clock,
            instance,
            refusals: Refusals::default(),
            warn: Box::new(|_| {}),
        })
    }

    pub fn set_warn(&mut self, warn: Warn) {
        self.warn = warn;
    }

    /// Returns the time on the program's clock (s).
    pub fn now(&self) -> f64 {
        (self.clock)()
    }

    /// Publishes `message`.
    pub fn publish<M: Message>(&self, topic: Topic, message: &M) -> Result<(), LinkError> {
        send(&*self.network, topic, message)
    }

    /// Warns the operator.
    pub fn warn(&mut self, text: &str) {
        (self.warn)(text);
    }

    /// Returns the mismatches of refused programs that have not been reported yet.
    pub fn new_refusals(&mut self) -> Vec<Mismatch> {
        let now = self.now();
        self.refusals.new_ones(self.inbox.lock().peers(), now)
    }

    /// Warns the operator of refused programs that have not been reported yet, and returns the last mismatch.
    pub fn warn_of_refusals(&mut self) -> Option<Mismatch> {
        let new = self.new_refusals();
        for mismatch in &new {
            self.warn(&format!("refused: {mismatch}"));
        }
        new.into_iter().last()
    }
}

/// Returns the first heartbeat of a program with the given experiment (SHA-256), with a random instance.
pub(super) fn first_heartbeat(program: ProgramKind, experiment: &str) -> Heartbeat {
    Heartbeat {
        instance: draw_instance(),
        program,
        finger: NO_FINGER,
        experiment: experiment.into(),
        age: f64::NAN,
        ..Heartbeat::default()
    }
}
