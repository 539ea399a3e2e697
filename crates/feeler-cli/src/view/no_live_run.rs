//! Replacement for the live page in builds without it.

use super::{MISSING, ServerArguments};
use crate::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::RunEnd;
use std::io::Write;

/// A live page, which cannot exist in this build.
pub enum LiveRun {}

impl LiveRun {
    /// Returns an error, because this build has no live page.
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
