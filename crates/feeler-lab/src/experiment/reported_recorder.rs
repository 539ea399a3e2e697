//! Recorder that also collects the data of the report.

use feeler_record::{
    MessageSink, RecordError, RecordOptions, RecordedMessage, RecordedTopic, Recorder, Recording,
    RunEnd, RunFacts,
};
use feeler_report::RunData;
use feeler_report::run::RunRecorder;

/// Records a run in a file and collects the columns of its report, so that the file need not be read again.
pub(super) struct ReportingRecorder {
    recorder: Recorder,
    /// `None` if the report is made from the file: if it contains images, or messages were dropped.
    columns: Option<RunRecorder>,
}

/// A recording and its columns, identical to those read from the file.
pub(super) type Recorded = (Recording, RunData);

impl ReportingRecorder {
    /// Creates a recorder that writes a run with the constants `facts` to `recorder`.
    ///
    /// # Errors
    /// If the constants are invalid.
    pub fn new(
        recorder: Recorder,
        facts: &RunFacts,
        experiment_toml: &str,
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        let columns = match options.pictures {
            true => None,
            false => {
                let mut columns = RunRecorder::new(facts)?;
                let recording = columns.recording_mut();
                recording.experiment = experiment_toml.into();
                recording.calibrations.clone_from(&options.calibrations);
                recording.policy.clone_from(&options.policy);
                Some(columns)
            }
        };
        Ok(Self { recorder, columns })
    }

    /// Disables the columns: a run in real time cannot wait while the rows of a long run are decimated.
    pub fn without_columns(&mut self) {
        self.columns = None;
    }

    /// Closes the file of a run with the duration `wall_time` (s) and the given `end`. Returns its content, or `None`
    /// if it must be read from the file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self, wall_time: f64, end: RunEnd) -> Result<Option<Recorded>, RecordError> {
        self.recorder.set_end(end.clone());
        let digest = self.recorder.finish(Some(wall_time))?;
        let recorded = self.columns.map(|columns| {
            let (mut recording, data) = columns.finish();
            recording.digest = digest;
            recording.complete = true;
            recording.end = end;
            recording.wall_time = Some(wall_time);
            (recording, data)
        });
        Ok(recorded)
    }
}

impl MessageSink for ReportingRecorder {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        if let Some(columns) = &mut self.columns
            && columns.keeps(topic)
        {
            columns.write(topic, message)?;
        }
        self.recorder.write(topic, message)
    }

    fn is_for_viewers(&self) -> bool {
        self.recorder.is_for_viewers()
    }

    fn step_ends(&mut self) -> Result<bool, RecordError> {
        if let Some(columns) = &mut self.columns {
            columns.step_ends()?;
        }
        let is_whole = self.recorder.step_ends()?;
        if !is_whole {
            self.columns = None;
        }
        Ok(is_whole)
    }
}
