//! Placeholder for the live page in a program built without it.

use super::{MISSING, ServerArguments};
use crate::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::{Felt, RunEnd};
use std::io::Write;

/// Placeholder for the options of a page's server.
pub struct ServerOptions;

impl From<&ServerArguments> for ServerOptions {
    fn from(_: &ServerArguments) -> Self {
        Self
    }
}

/// Live page of a run; uninhabited, because this build cannot serve one.
pub enum LiveRun {}

impl LiveRun {
    /// Returns an error: this build has no live page.
    pub fn open(_: &Experiment, _: ServerOptions, _: &mut dyn Write) -> Result<Self, CommandError> {
        Err(format!("--view: {MISSING}").into())
    }

    pub fn step(&mut self, _: &mut SimulatedLoop, _: &Instruments) -> Option<Felt> {
        match *self {}
    }

    pub fn over(&self, _: &SimulatedLoop, _: &RunEnd) {
        match *self {}
    }

    pub fn leave(self, _: Option<&CommandError>) {
        match self {}
    }
}
