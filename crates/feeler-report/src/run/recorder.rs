//! Converts a run to columns while it is being recorded.

use super::data::RunData;
use super::long_run::{LongRun, MEMORY};
use feeler_record::{
    MemoryRecorder, MessageSink, RecordError, RecordedMessage, RecordedTopic, Recording, RunFacts,
};

/// Number of control steps between conversions. Small, so that messages stay in the processor's cache and in the
/// allocator's free lists (glibc caches seven blocks per size).
const STEPS: usize = 3;

/// Message sink that converts a run to columns. The result equals that of [`read`](super::read) on a recording of the
/// same messages, without reading a file. Ignores images.
pub struct RunRecorder {
    recorder: MemoryRecorder,
    run: LongRun,
    steps: usize,
}

impl RunRecorder {
    /// Recorder for a run with these constants.
    ///
    /// # Errors
    /// If the facts are invalid.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        let mut recorder = MemoryRecorder::new(facts)?;
        Ok(Self {
            run: LongRun::new(recorder.recording_mut(), MEMORY),
            recorder,
            steps: 0,
        })
    }

    /// `true` if messages of this topic are recorded. Topics for viewers only are not.
    pub fn keeps<M: RecordedMessage>(&mut self, topic: RecordedTopic<M>) -> bool {
        M::list(self.recording_mut(), topic.finger()).is_some()
    }

    /// Recording so far, without the messages that have been converted to rows.
    pub fn recording_mut(&mut self) -> &mut Recording {
        self.recorder.recording_mut()
    }

    /// Returns the recording, reduced to its facts, latest messages and findings, and the columns.
    pub fn finish(self) -> (Recording, RunData) {
        let mut recording = self.recorder.into_recording();
        let data = self.run.finish(&mut recording);
        (recording, data)
    }
}

impl MessageSink for RunRecorder {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        self.recorder.write(topic, message)
    }

    fn step_ends(&mut self) -> Result<bool, RecordError> {
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS) {
            let recording = self.recorder.recording_mut();
            self.run.take(recording, recording.readable_until);
        }
        self.recorder.step_ends()
    }
}
