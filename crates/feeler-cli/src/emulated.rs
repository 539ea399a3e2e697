//! Runs over an emulated bus of servos.

use super::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::experiment::driven;

pub use feeler_lab::experiment::driven::DrivenBus;

/// A run of `experiment` over an emulated bus, at `speed`; and the bus.
pub fn session(experiment: &Experiment, speed: f64) -> Result<(Session, DrivenBus), CommandError> {
    Ok(driven::session(experiment, speed)?)
}
