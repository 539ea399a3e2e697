//! What somebody who waits for a run sees of it: a bar, or the whole system.

use super::CommandError;
use super::progress::Progress;
use super::screen::Screen;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, Session};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Shows a run while it goes on.
pub enum Watcher {
    /// How far it is.
    Bar(Progress),
    /// All of it, on the whole terminal.
    Screen(Box<Screen>),
}

impl Watcher {
    /// Begins to watch a run of `experiment`; with `top`, on the whole terminal. `interrupted` is raised when
    /// whoever watches has had enough.
    pub fn new(
        top: bool,
        experiment: &Experiment,
        interrupted: &Arc<AtomicBool>,
    ) -> Result<Self, CommandError> {
        if top {
            let screen = Screen::open(experiment, interrupted)?;
            Ok(Self::Screen(Box::new(screen)))
        } else {
            Ok(Self::Bar(Progress::new(experiment)))
        }
    }

    /// Shows the newest step of `session`, which was started at `start` and of which `late` steps were late;
    /// does to the hand what whoever watches asks for.
    pub fn step(
        &mut self,
        session: &mut Session,
        instruments: &Instruments,
        late: Option<u64>,
        start: Instant,
    ) {
        match self {
            Self::Bar(progress) => progress.show(session, start),
            Self::Screen(screen) => screen.step(session, instruments, late),
        }
    }

    /// Takes the bar off; a screen stays, to be looked at.
    pub fn run_ended(&self) {
        if let Self::Bar(progress) = self {
            progress.clear();
        }
    }

    /// Leaves when whoever watches does: at once, unless there is a screen.
    pub fn leave(self, session: &Session) {
        if let Self::Screen(screen) = self {
            screen.wait_for_quit(session);
        }
    }
}
