//! Complete runs recorded in memory.

use super::{ExperimentError, Session};
use crate::config::ExperimentConfig;
use feeler_record::{Recording, RunLog};
use feeler_report::RunData;
use feeler_report::run::RunRecorder;

impl Session {
    /// Steps until the run is [`finished`](Self::finished). Returns the recording and the columns of its report.
    /// `config` must be the configuration of the session's experiment.
    ///
    /// # Errors
    /// If a sensor or the hand fails, or a message cannot be recorded.
    pub fn run_in_memory(
        &mut self,
        config: &ExperimentConfig,
    ) -> Result<(Recording, RunData), ExperimentError> {
        let facts = self.facts(config);
        let mut log = RunLog::new(RunRecorder::new(&facts)?, &facts)?;
        while !self.finished() {
            let instruments = self.step()?;
            instruments.record(self.control_loop(), &mut log)?;
        }
        Ok(log.into_recorder().finish())
    }
}
