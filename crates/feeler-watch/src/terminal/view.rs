//! Terminal output and input: a thread that draws the latest snapshot and reads keys.

use super::action::Action;
use super::draw::draw;
use crate::snapshot::Snapshot;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::cursor::Show;
use ratatui::crossterm::event::{self, Event};
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use std::io::{self, BufWriter, IsTerminal, Stderr, stderr, stdin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Minimum time between two drawn snapshots: 30 per second.
const FRAME_INTERVAL: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// Interval at which the drawing thread checks for work.
const PATIENCE: Duration = Duration::from_millis(10);

/// Maximum time to wait for the drawing thread when the view is closed.
const FAREWELL: Duration = Duration::from_millis(500);

/// `true` while the terminal shows the view. Global, because there is only one terminal.
static SHOWN: AtomicBool = AtomicBool::new(false);

/// Error that prevents a view.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// Input or output is not a terminal.
    #[error("{0} is not a terminal; run this program in a terminal, without redirection")]
    NoTerminal(&'static str),
    /// The program runs in the background of the terminal, where the system would suspend it.
    #[error(
        "this program is in the background of its terminal; run it in the foreground: without &, and with timeout --foreground"
    )]
    Background,
    /// The terminal lacks a required function.
    #[error("the terminal cannot be used: {0}")]
    Terminal(#[from] io::Error),
}

/// A view on the terminal. It draws on standard error, so that results can be written to standard output. The
/// terminal is restored when the view is dropped, and before a panic is printed.
pub struct View {
    shared: Arc<Shared>,
    actions: Receiver<Action>,
    /// The drawing thread; it ends when the view is closed or the terminal fails.
    thread: Option<JoinHandle<io::Result<()>>>,
    shown: Option<Instant>,
}

struct Shared {
    /// Latest snapshot that is not drawn yet.
    newest: Mutex<Option<Snapshot>>,
    /// `true` if the view is being closed.
    closing: AtomicBool,
    /// `true` if the user wants to quit.
    quit: Arc<AtomicBool>,
}

impl View {
    /// Checks that there is a usable terminal.
    ///
    /// # Errors
    /// If standard input or standard error is not a terminal, or the program runs in its background.
    pub fn check_terminal() -> Result<(), ViewError> {
        if !stderr().is_terminal() {
            return Err(ViewError::NoTerminal("standard error"));
        }
        if !stdin().is_terminal() {
            return Err(ViewError::NoTerminal("standard input"));
        }
        if is_in_background() {
            return Err(ViewError::Background);
        }
        Ok(())
    }

    /// Switches the terminal to the view. `quit` is set when the user quits; if it is set by other code,
    /// [`wait_for_quit`](Self::wait_for_quit) ends.
    ///
    /// # Errors
    /// If there is no terminal, or it cannot be used.
    pub fn open(quit: &Arc<AtomicBool>) -> Result<Self, ViewError> {
        Self::check_terminal()?;
        let shared = Arc::new(Shared {
            newest: Mutex::new(None),
            closing: AtomicBool::new(false),
            quit: Arc::clone(quit),
        });
        restore_on_panic(Arc::clone(&shared));
        let (sender, actions) = channel();
        // From here on, dropping the view restores the terminal.
        let mut view = Self {
            shared,
            actions,
            thread: None,
            shown: None,
        };
        SHOWN.store(true, Ordering::Relaxed);
        enable_raw_mode()?;
        execute!(stderr(), EnterAlternateScreen)?;
        let terminal = Terminal::new(CrosstermBackend::new(BufWriter::new(stderr())))?;
        let shared = Arc::clone(&view.shared);
        let drawing = move || keep_drawing(terminal, &shared, &sender);
        view.thread = Some(thread::Builder::new().name("view".into()).spawn(drawing)?);
        Ok(view)
    }

    /// Shows the result of `snapshot`, unless the last one was drawn too recently. Does not wait for the terminal.
    pub fn show(&mut self, snapshot: impl FnOnce() -> Snapshot) {
        let now = Instant::now();
        if self.shown.is_some_and(|shown| now - shown < FRAME_INTERVAL) {
            return;
        }
        self.shown = Some(now);
        // The drawing thread holds the lock only while taking a snapshot out.
        if let Ok(mut newest) = self.shared.newest.try_lock() {
            *newest = Some(snapshot());
        }
    }

    /// Returns the actions requested since the last call, except quitting.
    pub fn actions(&self) -> impl Iterator<Item = Action> {
        self.actions.try_iter()
    }

    /// Shows `snapshot` until the user quits.
    pub fn wait_for_quit(&mut self, snapshot: Snapshot) {
        let newest = self.shared.newest.lock();
        *newest.unwrap_or_else(PoisonError::into_inner) = Some(snapshot);
        while self.is_open() && !self.shared.quit.load(Ordering::Relaxed) {
            thread::sleep(PATIENCE);
        }
    }

    /// Returns `true` while the view is displayed.
    pub fn is_open(&self) -> bool {
        self.thread
            .as_ref()
            .is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.shared.closing.store(true, Ordering::Relaxed);
        // If the terminal is gone, crossterm may read forever; if it accepts no output, writing may block forever. In
        // both cases the threads are abandoned until the process exits.
        wait_for(self.thread.as_ref());
        match thread::Builder::new().spawn(restore) {
            Ok(restoring) => wait_for(Some(&restoring)),
            Err(_) => restore(),
        }
    }
}

/// Waits for `thread` to end, up to [`FAREWELL`].
fn wait_for<T>(thread: Option<&JoinHandle<T>>) {
    let start = Instant::now();
    while thread.is_some_and(|thread| !thread.is_finished()) && start.elapsed() < FAREWELL {
        thread::sleep(PATIENCE);
    }
}

/// Returns `true` if the terminal's foreground process group is not that of this program.
#[cfg(target_os = "linux")]
fn is_in_background() -> bool {
    let foreground = rustix::termios::tcgetpgrp(stderr());
    // The system does not halt a program for using a terminal of another session.
    foreground.is_ok_and(|foreground| foreground != rustix::process::getpgrp())
}

/// Returns `false`, because this is unknown on this platform.
#[cfg(not(target_os = "linux"))]
fn is_in_background() -> bool {
    false
}

/// Restores the terminal if the view uses it.
fn restore() {
    if SHOWN.swap(false, Ordering::Relaxed) {
        // Errors mean that the terminal is gone.
        let _ = disable_raw_mode();
        let _ = execute!(stderr(), LeaveAlternateScreen, Show);
    }
}

/// Restores the terminal before a panic of any thread is printed.
fn restore_on_panic(shared: Arc<Shared>) {
    let tell = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        shared.closing.store(true, Ordering::Relaxed);
        restore();
        tell(panic);
    }));
}

fn keep_drawing(
    mut terminal: Terminal<CrosstermBackend<BufWriter<Stderr>>>,
    shared: &Shared,
    actions: &Sender<Action>,
) -> io::Result<()> {
    let mut snapshot = Snapshot::default();
    while !shared.closing.load(Ordering::Relaxed) {
        let resized = read_events(shared, actions)?;
        let newest = shared.newest.lock();
        let newest = newest.unwrap_or_else(PoisonError::into_inner).take();
        let is_new = newest.is_some();
        snapshot = newest.unwrap_or(snapshot);
        if (is_new || resized) && !shared.closing.load(Ordering::Relaxed) {
            terminal.draw(|frame| draw(frame, &snapshot))?;
        }
    }
    Ok(())
}

/// Waits briefly for keys and sends their actions; returns `true` if the screen was resized.
fn read_events(shared: &Shared, actions: &Sender<Action>) -> io::Result<bool> {
    let mut resized = false;
    let mut patience = PATIENCE;
    while event::poll(patience)? {
        patience = Duration::ZERO;
        let event = event::read()?;
        resized |= matches!(event, Event::Resize(..));
        match Action::of(&event) {
            Some(Action::Quit) => shared.quit.store(true, Ordering::Relaxed),
            // The receiver is gone while the view is being closed.
            Some(action) => drop(actions.send(action)),
            None => {}
        }
    }
    Ok(resized)
}
