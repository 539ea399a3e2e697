//! Stub of the terminal view for builds without it.

use super::CommandError;
use feeler::pace::Tick;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const MISSING: &str =
    "--top: this program was built without the terminal view; build it with --features top";

/// Uninhabited.
pub enum Screen {}

impl Screen {
    /// Returns an error: this build has no terminal view.
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
