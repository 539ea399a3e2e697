//! In place of the live page where the program was built without it.

use super::{MISSING, ServerArguments};
use crate::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::RunEnd;
use std::io::Write;

/// There is none.
pub enum LiveRun {}

impl LiveRun {
    /// Says that there is no such thing.
    pub fn open(
        _: &Experiment,
        _: &ServerArguments,
        _: &mut dyn Write,
    ) -> Result<Self, CommandError> {
        Err(format!("--view: {MISSING}").into())
    }

    pub fn step(&mut self, _: &mut SimulatedLoop, _: &Instruments) {
        match *self {}
    }

    pub fn over(&self, _: &SimulatedLoop, _: &RunEnd) {
        match *self {}
    }

    pub fn leave(self, _: Option<&CommandError>) {
        match self {}
    }
}
