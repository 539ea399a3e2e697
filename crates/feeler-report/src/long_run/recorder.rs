//! A run as columns while it is recorded.

use super::{LongRun, MEMORY};
use crate::run_data::RunData;
use feeler_record::{
    MemoryRecorder, MessageSink, RecordError, RecordedMessage, RecordedTopic, Recording, RunFacts,
};

/// Control steps of which messages are kept before they become rows: so few that their memory is still in the processor's cache, and that
/// the system's library has it at hand for the next ones (glibc keeps seven pieces of a size for that).
const STEPS: usize = 3;

/// Makes columns of a run's messages as they come: what [`read`](super::read) gives of a recording of them, which need not be read
/// again then. Takes no pictures.
pub struct RunRecorder {
    recorder: MemoryRecorder,
    run: LongRun,
    steps: usize,
}

impl RunRecorder {
    /// For a run of these constants.
    ///
    /// # Errors
    /// When the facts make no sense.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        let mut recorder = MemoryRecorder::new(facts)?;
        Ok(Self {
            run: LongRun::new(recorder.recording_mut(), MEMORY),
            recorder,
            steps: 0,
        })
    }

    /// Whether it takes messages of this topic: not those that are for viewers only.
    pub fn keeps<M: RecordedMessage>(&mut self, topic: RecordedTopic<M>) -> bool {
        M::list(self.recording_mut(), topic.finger()).is_some()
    }

    /// What is recorded so far, without what became rows already.
    pub fn recording_mut(&mut self) -> &mut Recording {
        self.recorder.recording_mut()
    }

    /// The recording, of which are left its facts, its newest messages, and what was found out; and the columns.
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
