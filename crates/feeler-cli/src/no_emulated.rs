//! Stub of [`emulated`](super::emulated) for builds without servos.

use super::CommandError;
use feeler::pace::{PaceError, Schedule};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::grips::GripTrial;

const WITHOUT_SERVOS: &str =
    "--drives: this program was built without servos; build it on Linux with --features drives";

/// Uninhabited.
pub enum EmulatedBus {}

impl EmulatedBus {
    pub fn schedule(&self, _: f64) -> Result<Box<dyn Schedule>, PaceError> {
        match *self {}
    }

    pub fn is_paced(&self) -> bool {
        match *self {}
    }
}

/// Returns an error: this build has no servos.
pub fn session(_: &Experiment, _: f64) -> Result<(Session, EmulatedBus), CommandError> {
    Err(WITHOUT_SERVOS.into())
}

/// Returns an error: this build has no servos.
pub fn grip_trial(_: &Experiment, _: u64) -> Result<GripTrial, String> {
    Err(WITHOUT_SERVOS.into())
}
