//! In place of runs over an emulated bus of servos where the program was built without it.

use super::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;

/// There is none.
pub enum Emulator {}

/// Says that there is no such thing.
pub fn session(_: &Experiment, _: f64) -> Result<(Session, Emulator), CommandError> {
    Err(
        "--drives: this program was built without servos; build it on Linux with --features drives"
            .into(),
    )
}
