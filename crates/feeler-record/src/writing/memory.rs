//! Destinations for a run's messages: a trait, and an implementation in memory.

use crate::error::RecordError;
use crate::messages::facts::RunFacts;
use crate::messages::recorded::RecordedMessage;
use crate::messages::topic::RecordedTopic;
use crate::reading::container::log_time;
use crate::reading::recording::Recording;

/// A destination for the messages of a run. Messages of each topic are written in order of time.
pub trait MessageSink {
    /// Writes `message` to `topic`.
    ///
    /// # Errors
    /// If the run has no such finger or topic (images are optional), the stamp is not a valid time, or an earlier
    /// message could not be written.
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError>;

    /// Returns `true` if the recording may be opened in a viewer. Messages derived from others are only written then.
    fn is_for_viewers(&self) -> bool {
        false
    }

    /// Marks the end of a control step. Returns `false` if messages were dropped since the last call.
    ///
    /// # Errors
    /// If an earlier message could not be written.
    fn step_ends(&mut self) -> Result<bool, RecordError> {
        Ok(true)
    }
}

/// Stores a run's messages in memory. The result equals the recording read from a file, except for the digest, which is
/// computed from encoded messages. Does not support images.
pub struct MemoryRecorder {
    recording: Recording,
}

impl MemoryRecorder {
    /// Creates a recorder for the run described by `facts`.
    ///
    /// # Errors
    /// If the facts are invalid.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        facts.validate()?;
        let recording = Recording::empty(facts.clone());
        Ok(Self { recording })
    }

    /// Returns the recording so far. Parts that are no longer needed may be [discarded](Recording::discard_until).
    pub fn recording_mut(&mut self) -> &mut Recording {
        &mut self.recording
    }

    /// Returns the recording.
    pub fn into_recording(self) -> Recording {
        self.recording
    }
}

impl MessageSink for MemoryRecorder {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let recording = &mut self.recording;
        topic.check_finger(recording.fingers.len())?;
        // Checked as in a file, whose clock counts nanoseconds.
        let time = log_time(topic, message)?;
        let list = M::list(recording, topic.finger());
        let list = list.ok_or_else(|| RecordError::NotRegistered {
            topic: topic.name(),
        })?;
        list.push(message.clone());
        recording.readable_until = recording.readable_until.max(time as f64 * 1e-9);
        Ok(())
    }
}
