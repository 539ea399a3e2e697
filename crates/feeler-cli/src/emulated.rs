//! Runs over an emulated bus of servos.

use super::CommandError;
use feeler_drives::emulator::Emulator;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Session, driven};

/// A run of `experiment` over an emulated bus, at `speed`; and the bus.
pub fn session(experiment: &Experiment, speed: f64) -> Result<(Session, Emulator), CommandError> {
    if !speed.is_finite() {
        let expected = "servos keep their own time; expected a number, at most 1 where the computer shall keep up";
        return Err(format!("--speed max with --drives: {expected}").into());
    }
    Ok(driven::session(experiment, speed)?)
}
