//! In place of the terminal view where the program was built without it.

use super::CommandError;
use feeler::pace::Tick;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const MISSING: &str =
    "--top: this program was built without the terminal view; build it with --features top";

/// There is none.
pub enum Screen {}

impl Screen {
    /// Says that there is no such thing.
    pub fn check() -> Result<(), CommandError> {
        Err(MISSING.into())
    }

    pub fn open(_: &Experiment, _: bool, _: &Arc<AtomicBool>) -> Result<Self, CommandError> {
        Err(MISSING.into())
    }

    pub fn step(&mut self, _: &mut SimulatedLoop, _: &Instruments, _: &Tick) {
        match *self {}
    }

    pub fn wait_for_quit(self, _: &SimulatedLoop) {
        match self {}
    }
}
