//! The seam between what a program has to say and what carries it.

use super::endpoints::LinkError;
use super::message::{MessageHeader, PROTOCOL};
use super::topic::Topic;
use feeler_record::wire::{Message, cdr};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;

/// Carries messages to other programs.
pub trait Outlet: Send + Sync {
    /// Sends the bytes of a message. What cannot be sent at once is dropped.
    ///
    /// # Errors
    /// When nothing can be sent any more.
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError>;
}

/// A program's clock: seconds since it started.
pub type TimeSource = Arc<dyn Fn() -> f64 + Send + Sync>;

/// Seconds since now, by the system's monotonic clock.
pub fn monotonic() -> TimeSource {
    let start = std::time::Instant::now();
    Arc::new(move || start.elapsed().as_secs_f64())
}

/// Sends `message`.
///
/// # Errors
/// As [`Outlet::send`].
pub fn send<M: Message>(outlet: &dyn Outlet, topic: Topic, message: &M) -> Result<(), LinkError> {
    outlet.send(topic, encode(message)?)
}

/// The bytes of `message`.
///
/// # Errors
/// When they cannot be made; no message of ours causes that.
pub fn encode<M: Message>(message: &M) -> Result<Vec<u8>, LinkError> {
    let mut bytes = Vec::new();
    cdr::encode(message, &mut bytes).map_err(|e| LinkError::Transport(e.to_string()))?;
    Ok(bytes)
}

/// A number that no other program has drawn, but for bad luck of one in 2^64.
pub fn draw_instance() -> u64 {
    // The standard library keys every such hasher by numbers from the system.
    RandomState::new().build_hasher().finish()
}

/// The header of a message by `instance` on its own clock that echoes nothing.
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
