//! In place of runs over an emulated bus of servos where the program was built without it.

use super::CommandError;
use feeler::pace::{PaceError, Schedule};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;

/// There is none.
pub enum DrivenBus {}

impl DrivenBus {
    pub fn schedule(&self, _: f64) -> Result<Box<dyn Schedule>, PaceError> {
        match *self {}
    }

    pub fn is_paced(&self) -> bool {
        match *self {}
    }
}

/// Says that there is no such thing.
pub fn session(_: &Experiment, _: f64) -> Result<(Session, DrivenBus), CommandError> {
    Err(
        "--drives: this program was built without servos; build it on Linux with --features drives"
            .into(),
    )
}
