//! Sending of messages, independent of the transport.

use super::endpoints::LinkError;
use super::topic::Topic;
use crate::messages::message::{MessageHeader, PROTOCOL};
use feeler_record::wire::{Message, cdr};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;

/// Sends messages to other programs.
pub trait Outlet: Send + Sync {
    /// Sends an encoded message, or drops it if it cannot be sent immediately.
    ///
    /// # Errors
    /// If the link has failed.
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError>;
}

/// Clock of a program, in seconds since its start.
pub type TimeSource = Arc<dyn Fn() -> f64 + Send + Sync>;

/// Returns a monotonic clock that starts at 0 now.
pub fn monotonic() -> TimeSource {
    let start = std::time::Instant::now();
    Arc::new(move || start.elapsed().as_secs_f64())
}

/// Encodes and sends `message`.
///
/// # Errors
/// If encoding fails or the link has failed.
pub fn send<M: Message>(outlet: &dyn Outlet, topic: Topic, message: &M) -> Result<(), LinkError> {
    outlet.send(topic, encode(message)?)
}

/// Encodes `message` as CDR.
///
/// # Errors
/// If encoding fails, which does not occur with feeler's messages.
pub fn encode<M: Message>(message: &M) -> Result<Vec<u8>, LinkError> {
    let mut bytes = Vec::new();
    cdr::encode(message, &mut bytes).map_err(|e| LinkError::Transport(e.to_string()))?;
    Ok(bytes)
}

/// Draws a random instance number. Two programs draw the same number with a probability of 2^-64.
pub fn draw_instance() -> u64 {
    // The standard library seeds each such hasher with random numbers from the system.
    RandomState::new().build_hasher().finish()
}

/// Returns a header without an echo, stamped by the clock of `instance` itself.
pub fn header(instance: u64, sequence: u64, stamp: f64) -> MessageHeader {
    MessageHeader {
        protocol: PROTOCOL,
        instance,
        clock: instance,
        sequence,
        stamp,
        echo_step: 0,
        echo_token: 0,
        echo_age: 0.0,
    }
}
