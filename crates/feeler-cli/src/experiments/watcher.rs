//! Display of a run in progress: a progress bar, the terminal view or the browser view.

use crate::CommandError;
use crate::experiments::run_progress::Progress;
#[cfg(not(feature = "top"))]
use crate::no_screen::Screen;
use crate::view::LiveRun;
use feeler::pace::Tick;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::{Felt, RunEnd};
#[cfg(feature = "top")]
use feeler_watch::Screen;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Shows a run in progress.
pub struct Watcher<'a> {
    shown: Shown,
    /// Browser view, if requested.
    page: Option<&'a mut LiveRun>,
}

/// Display on the terminal.
enum Shown {
    /// A progress bar.
    Bar(Progress),
    /// The full-screen terminal view.
    Screen(Box<Screen>),
}

impl<'a> Watcher<'a> {
    /// Creates the display of a run of `experiment`: full-screen with `top`, and on `page` if given. `is_paced` is
    /// `true` if steps are tied to real time. `interrupted` is set when the user quits.
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

    /// Shows the latest step of `control_loop`, and executes the user's actions on the hand. Returns the browser's
    /// report of the rumble and tone that it plays, if there is a new one.
    pub fn step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        instruments: &Instruments,
        tick: &Tick,
    ) -> Option<Felt> {
        match &mut self.shown {
            Shown::Bar(progress) => progress.show(control_loop),
            Shown::Screen(screen) => screen.step(control_loop, instruments, tick),
        }
        let page = self.page.as_mut()?;
        page.step(control_loop, instruments)
    }

    /// Removes the progress bar; the terminal view remains.
    pub fn run_ended(&self) {
        if let Shown::Bar(progress) = &self.shown {
            progress.clear();
        }
    }

    /// Shows the end of the run in the browser. With the terminal view, waits until the user quits.
    pub fn leave(self, control_loop: &SimulatedLoop, end: &RunEnd) {
        if let Some(page) = self.page {
            page.over(control_loop, end);
        }
        if let Shown::Screen(screen) = self.shown {
            screen.wait_for_quit(control_loop);
        }
    }
}
