//! What programs have in common that hear messages.

use super::beacon::Beacon;
use super::endpoints::LinkError;
use super::network::Network;
use super::outlet::TimeSource;
use super::peers::Peers;
use super::rejection::{Rejection, Rejections};
use super::shared::Shared;
use super::topic::Topic;
use feeler_record::wire::{Message, cdr};
use std::sync::Arc;

/// Takes in what arrives for a program.
pub trait Inbox {
    /// Takes in a message that came at `now`, s on the program's clock; no longer than its topic allows.
    ///
    /// # Errors
    /// When it is not taken.
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection>;

    /// The other programs.
    fn peers(&self) -> &Peers;

    /// What was not taken, for [`take`](Self::take) to count.
    fn rejected(&mut self) -> &mut Rejections;

    /// Whether what has arrived is worth waking who waits for it.
    fn is_worth_waking(&self) -> bool {
        true
    }

    /// Takes in a message that came at `now`, s on the program's clock, or counts it as rejected.
    ///
    /// # Errors
    /// When it is not taken.
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

/// Reads a message.
///
/// # Errors
/// When the bytes are not those of one.
pub fn read<M: Message>(bytes: &[u8]) -> Result<M, Rejection> {
    cdr::decode(bytes).map_err(|_| Rejection::Malformed)
}

/// Lets `inbox` take in all messages of `topics`, and `beacon` greet programs that are new.
///
/// # Errors
/// When nothing can be heard.
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
                // What is refused is counted there.
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
