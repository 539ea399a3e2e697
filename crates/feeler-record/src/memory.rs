//! Where a run's messages go: to a file, or into memory when nobody wants the file.

use super::container::log_time;
use super::error::RecordError;
use super::facts::RunFacts;
use super::recording::Recording;
use super::topic::{RecordedMessage, RecordedTopic};

/// Takes the messages of a run, each topic's in the order of time.
pub trait MessageSink {
    /// Takes `message`, which belongs to `topic`.
    ///
    /// # Errors
    /// When the run has no such finger or topic (pictures are optional), when the stamp is no time, or when an
    /// earlier message could not be written.
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError>;

    /// Whether somebody may look at it in a viewer: what follows from other messages is written only then.
    fn is_for_viewers(&self) -> bool {
        false
    }

    /// All messages of a control step were written. Whether none was dropped since the last time.
    ///
    /// # Errors
    /// When an earlier message could not be written.
    fn step_ends(&mut self) -> Result<bool, RecordError> {
        Ok(true)
    }
}

/// A run's messages in memory: what reading its recording would give, but for the digest, which is of encoded
/// messages. Takes no pictures.
pub struct MemoryRecorder {
    recording: Recording,
}

impl MemoryRecorder {
    /// For a run of these constants.
    ///
    /// # Errors
    /// When the facts make no sense.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        facts.validate()?;
        let recording = Recording::empty(facts.clone());
        Ok(Self { recording })
    }

    /// What was recorded so far; who needs no more of a part of it may [let go of it](Recording::forget_until).
    pub fn recording_mut(&mut self) -> &mut Recording {
        &mut self.recording
    }

    /// What was recorded.
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
        // As in the file, whose clock counts nanoseconds.
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
