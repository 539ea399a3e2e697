//! Reception of messages, common to all programs.

use super::beacon::Beacon;
use super::peers::Peers;
use crate::messages::rejection::{Rejection, Rejections};
use crate::transport::endpoints::LinkError;
use crate::transport::network::Network;
use crate::transport::outlet::TimeSource;
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use std::sync::Arc;

/// Receiver of a program's messages.
pub trait Inbox {
    /// Processes a message received at `now` (s, on the program's clock). The caller has checked its size.
    ///
    /// # Errors
    /// If the message is rejected.
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection>;

    /// Returns the other programs.
    fn peers(&self) -> &Peers;

    /// Returns the counters of rejected messages, which [`take`](Self::take) updates.
    fn rejected(&mut self) -> &mut Rejections;

    /// Returns `true` if threads waiting for this inbox must be woken for the latest message.
    fn is_worth_waking(&self) -> bool {
        true
    }

    /// Processes a message received at `now` (s, on the program's clock), or counts it as rejected.
    ///
    /// # Errors
    /// If the message is rejected.
    fn take(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        let taken = if bytes.len() > topic.most_bytes() {
            Err(Rejection::Oversized)
        } else {
            self.take_in(topic, bytes, now)
        };
        self.rejected().count(&taken);
        taken
    }
}

/// Passes all messages of `topics` to `inbox`, and sends a heartbeat from `beacon` when a new program appears.
///
/// # Errors
/// If a subscription fails.
pub fn listen<I: Inbox + Send + 'static>(
    network: &dyn Network,
    topics: &[Topic],
    inbox: &Shared<I>,
    clock: &TimeSource,
    beacon: &Arc<Beacon>,
) -> Result<(), LinkError> {
    for &topic in topics {
        let (inbox, clock, beacon) = (inbox.clone(), Arc::clone(clock), Arc::clone(beacon));
        let heard = move |topic, bytes: &[u8]| {
            let (is_new, wakes) = {
                let mut inbox = inbox.lock();
                let last = |inbox: &I| Some(inbox.peers().all().last()?.heartbeat.instance);
                let known = last(&inbox);
                // Rejections are counted in there.
                let _ = inbox.take(topic, bytes, clock());
                (last(&inbox) != known, inbox.is_worth_waking())
            };
            if wakes {
                inbox.changed();
            }
            if is_new {
                beacon.greet();
            }
        };
        network.listen(topic, Arc::new(heard))?;
    }
    Ok(())
}
