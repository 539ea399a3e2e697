//! What somebody who waits for a run sees of it: a bar, or the whole system.

use super::CommandError;
use super::progress::Progress;
use super::screen::Screen;
use feeler::pace::Tick;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Shows a run while it goes on.
pub enum Watcher {
    /// How far it is.
    Bar(Progress),
    /// All of it, on the whole terminal.
    Screen(Box<Screen>),
}

impl Watcher {
    /// Begins to watch a run of `experiment`, whose steps have real times where it `is_paced`; with `top`, on the
    /// whole terminal. `interrupted` is raised when whoever watches has had enough.
    pub fn new(
        top: bool,
        experiment: &Experiment,
        is_paced: bool,
        interrupted: &Arc<AtomicBool>,
    ) -> Result<Self, CommandError> {
        if top {
            let screen = Screen::open(experiment, is_paced, interrupted)?;
            Ok(Self::Screen(Box::new(screen)))
        } else {
            Ok(Self::Bar(Progress::new(experiment)))
        }
    }

    /// Shows the newest step of `control_loop`; does to the hand what whoever watches asks for.
    pub fn step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        instruments: &Instruments,
        tick: &Tick,
    ) {
        match self {
            Self::Bar(progress) => progress.show(control_loop),
            Self::Screen(screen) => screen.step(control_loop, instruments, tick),
        }
    }

    /// Takes the bar off; a screen stays, to be looked at.
    pub fn run_ended(&self) {
        if let Self::Bar(progress) = self {
            progress.clear();
        }
    }

    /// Leaves when whoever watches does: at once, unless there is a screen.
    pub fn leave(self, control_loop: &SimulatedLoop) {
        if let Self::Screen(screen) = self {
            screen.wait_for_quit(control_loop);
        }
    }
}
