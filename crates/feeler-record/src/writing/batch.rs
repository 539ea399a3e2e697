//! Batches of encoded messages that wait to be written to the file.

use crate::error::RecordError;
use crate::messages::channels::RecordingGap;
use crate::messages::recorded::RecordedMessage;
use crate::messages::topic::{Channel, RecordedTopic};
use crate::reading::container::{find, log_time};
use crate::wire::cdr;

/// Size in bytes at which a chunk is written. A larger chunk loses more if the program is killed; each chunk costs 0.6
/// KB in the index at the end.
pub const CHUNK_BYTES: usize = 512 * 1024;

/// Encoded messages that wait to be written to the file.
#[derive(Debug, Default)]
pub struct Batch {
    /// Gap before the first message, if any.
    pub gap: Option<RecordingGap>,
    /// Concatenated bytes of the messages.
    pub bytes: Vec<u8>,
    /// End and type of each message.
    pub messages: Vec<Entry>,
}

/// One message of a [`Batch`].
#[derive(Debug)]
pub struct Entry {
    /// Index of its channel, in order of registration.
    pub channel: usize,
    /// Log time (ns).
    pub log_time: u64,
    /// End of its bytes in the batch.
    pub end: usize,
}

impl Batch {
    /// Creates an empty batch with room for `messages` messages of `bytes` bytes in total.
    pub fn with_capacity(bytes: usize, messages: usize) -> Self {
        Self {
            gap: None,
            bytes: Vec::with_capacity(bytes),
            messages: Vec::with_capacity(messages),
        }
    }

    /// Encodes `message` and appends it. `channels` are all channels of the recording, of a rig with `fingers` fingers.
    ///
    /// # Errors
    /// If the topic is not registered, or its time or content cannot be encoded.
    pub fn push<M: RecordedMessage>(
        &mut self,
        channels: &[Channel],
        fingers: usize,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let channel = find(channels, fingers, topic)?;
        let log_time = log_time(topic, message)?;
        cdr::encode(message, &mut self.bytes)?;
        self.messages.push(Entry {
            channel,
            log_time,
            end: self.bytes.len(),
        });
        Ok(())
    }

    /// Returns `true` if the messages fill a chunk or span at least `flush_interval` (ns).
    pub fn is_full(&self, flush_interval: u64) -> bool {
        let is_full = self.bytes.len() >= CHUNK_BYTES || self.span() >= flush_interval;
        is_full && !self.messages.is_empty()
    }

    /// Removes all messages and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.gap = None;
        self.bytes.clear();
        self.messages.clear();
    }

    /// Run time between the first and the last message (ns).
    pub fn span(&self) -> u64 {
        let time = |entry: Option<&Entry>| entry.map_or(0, |entry| entry.log_time);
        time(self.messages.last()).saturating_sub(time(self.messages.first()))
    }

    /// Extends `gap`, if any, by this batch's messages.
    pub fn lost(&self, gap: Option<RecordingGap>) -> Option<RecordingGap> {
        let times = || self.messages.iter().map(|entry| entry.log_time);
        let (Some(first), Some(last)) = (times().min(), times().max()) else {
            return gap;
        };
        let (first, last) = (first as f64 * 1e-9, last as f64 * 1e-9);
        let before = gap.unwrap_or(RecordingGap {
            start: first,
            end: last,
            messages: 0,
        });
        Some(RecordingGap {
            start: before.start.min(first),
            end: before.end.max(last),
            messages: before.messages + self.messages.len() as u64,
        })
    }
}
