//! Runs over an emulated bus of servos.

use super::CommandError;
use feeler::pace::real_time::fine_timer;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::experiment::driven;

pub use feeler_lab::experiment::driven::DrivenBus;

/// A run of `experiment` over an emulated bus, at `speed`; and the bus.
pub fn session(experiment: &Experiment, speed: f64) -> Result<(Session, DrivenBus), CommandError> {
    let (session, bus) = driven::session(experiment, speed)?;
    if bus.is_paced() {
        // A period is short beside what the system sleeps too long; where it refuses, steps are that much later.
        let _ = fine_timer();
    }
    Ok((session, bus))
}
