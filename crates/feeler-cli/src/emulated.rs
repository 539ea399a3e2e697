//! Runs that use an emulated servo bus.

use super::CommandError;
use feeler::pace::real_time::fine_timer;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::experiment::rigs::driven;
use feeler_lab::grips::GripTrial;

pub use feeler_lab::experiment::rigs::driven::EmulatedBus;

/// Creates a session of `experiment` and the emulated servo bus that it uses, whose clock runs at `speed`.
pub fn session(
    experiment: &Experiment,
    speed: f64,
) -> Result<(Session, EmulatedBus), CommandError> {
    let (session, bus) = driven::session(experiment, speed)?;
    if bus.is_paced() {
        // A control period is short compared with the timer's default slack. If the system refuses a finer timer,
        // steps are late by that slack.
        let _ = fine_timer();
    }
    Ok((session, bus))
}

/// Runs the gripper of `experiment` with the object drawn with `seed`, moved by emulated servos in simulated time.
pub fn grip_trial(experiment: &Experiment, seed: u64) -> Result<GripTrial, String> {
    GripTrial::run_on_bus(experiment, seed).map_err(|error| error.to_string())
}
