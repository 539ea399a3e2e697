//! What somebody who waits for a run sees of it: a bar, or the whole system.

use super::CommandError;
#[cfg(not(feature = "top"))]
use super::no_screen::Screen;
use super::view::LiveRun;
use crate::run_progress::Progress;
use feeler::pace::Tick;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::RunEnd;
#[cfg(feature = "top")]
use feeler_watch::Screen;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Shows a run while it goes on.
pub struct Watcher<'a> {
    shown: Shown,
    /// Its page in the browser, if somebody may look at it there.
    page: Option<&'a mut LiveRun>,
}

/// What there is on the terminal.
enum Shown {
    /// How far it is.
    Bar(Progress),
    /// All of it, on the whole terminal.
    Screen(Box<Screen>),
}

impl<'a> Watcher<'a> {
    /// Begins to watch a run of `experiment`, whose steps have real times where it `is_paced`; with `top`, on the
    /// whole terminal; on its `page`, if there is one. `interrupted` is raised when whoever watches has had enough.
    pub fn new(
        top: bool,
        experiment: &Experiment,
        is_paced: bool,
        interrupted: &Arc<AtomicBool>,
        page: Option<&'a mut LiveRun>,
    ) -> Result<Self, CommandError> {
        let shown = if top {
            let screen = Screen::open(experiment, is_paced, interrupted)?;
            Shown::Screen(Box::new(screen))
        } else {
            Shown::Bar(Progress::new(experiment))
        };
        Ok(Self { shown, page })
    }

    /// Shows the newest step of `control_loop`; does to the hand what whoever watches asks for.
    pub fn step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        instruments: &Instruments,
        tick: &Tick,
    ) {
        match &mut self.shown {
            Shown::Bar(progress) => progress.show(control_loop),
            Shown::Screen(screen) => screen.step(control_loop, instruments, tick),
        }
        if let Some(page) = &mut self.page {
            page.step(control_loop, instruments);
        }
    }

    /// Takes the bar off; a screen stays, to be looked at.
    pub fn run_ended(&self) {
        if let Shown::Bar(progress) = &self.shown {
            progress.clear();
        }
    }

    /// Tells the page how the run ended, and leaves when whoever watches the screen does: at once, unless there is one.
    pub fn leave(self, control_loop: &SimulatedLoop, end: &RunEnd) {
        if let Some(page) = self.page {
            page.over(control_loop, end);
        }
        if let Shown::Screen(screen) = self.shown {
            screen.wait_for_quit(control_loop);
        }
    }
}
