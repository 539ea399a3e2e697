//! Encoded messages on their way to the file.

use super::channels::RecordingGap;

/// Encoded messages on their way to the file.
#[derive(Debug, Default)]
pub struct Batch {
    /// What is missing before its first message.
    pub gap: Option<RecordingGap>,
    /// The messages' bytes, one after the other.
    pub bytes: Vec<u8>,
    /// Where each message ends, and what it is.
    pub messages: Vec<Entry>,
}

/// One message of a [`Batch`].
#[derive(Debug)]
pub struct Entry {
    /// Index of its channel among those registered.
    pub channel: usize,
    /// Its time, ns.
    pub log_time: u64,
    /// Where its bytes end in the batch.
    pub end: usize,
}

impl Batch {
    /// An empty batch with room for so many bytes of so many messages.
    pub fn with_capacity(bytes: usize, messages: usize) -> Self {
        Self {
            gap: None,
            bytes: Vec::with_capacity(bytes),
            messages: Vec::with_capacity(messages),
        }
    }

    /// Empties the batch and keeps its memory.
    pub fn clear(&mut self) {
        self.gap = None;
        self.bytes.clear();
        self.messages.clear();
    }

    /// The run's time from its first message to its last, ns.
    pub fn span(&self) -> u64 {
        let time = |entry: Option<&Entry>| entry.map_or(0, |entry| entry.log_time);
        time(self.messages.last()).saturating_sub(time(self.messages.first()))
    }

    /// `gap`, if there is one already, and this batch's messages: what is missing where they are.
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
