//! Orders to a hand: stop and resume.

use crate::messages::message::{PROTOCOL, ResumeMessage, StopInForce, StopMessage};
use crate::messages::printable::printable;
use crate::transport::endpoints::LinkError;
use crate::transport::network::Network;
use crate::transport::outlet::{draw_instance, send};
use crate::transport::topic::Topic;

/// Order to a hand. Sending it repeatedly has the effect of sending it once.
pub enum Order {
    /// Stop.
    Stop(StopMessage),
    /// Resume a stop. The hand continues if no other stop is active.
    Resume(ResumeMessage),
}

impl Order {
    /// Creates a stop by `from` and returns it with its random id.
    pub fn stop(from: &str) -> (Self, u64) {
        let (protocol, from, id) = (PROTOCOL, printable(from), draw_instance());
        (Self::Stop(StopMessage { protocol, from, id }), id)
    }

    /// Creates an order by `from` to resume after the stop `number`.
    pub fn resume(from: &str, number: u64) -> Self {
        Self::Resume(ResumeMessage {
            protocol: PROTOCOL,
            from: printable(from),
            number,
        })
    }

    /// Sends the order once.
    ///
    /// # Errors
    /// If the network refuses the message.
    pub fn send(&self, network: &dyn Network) -> Result<(), LinkError> {
        match self {
            Self::Stop(message) => send(network, Topic::Stop, message),
            Self::Resume(message) => send(network, Topic::Resume, message),
        }
    }
}

/// Returns the active stop that `from` resumes by default: its own, else that of the hand itself. The stops of other
/// senders are resumed only by number.
pub fn stop_to_resume<'a>(stops: &'a [StopInForce], from: &str) -> Option<&'a StopInForce> {
    let (by, is_own) = (printable(from), |stop: &&StopInForce| stop.id == 0);
    let mine = stops.iter().find(|stop| stop.by == by);
    mine.or_else(|| stops.iter().find(is_own))
}
