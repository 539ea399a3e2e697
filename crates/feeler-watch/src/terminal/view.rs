//! The terminal: a thread that draws the newest snapshot and listens to the keys.

use super::action::Action;
use super::draw::draw;
use super::snapshot::Snapshot;
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

/// A snapshot is drawn this long after the one before at the earliest: 30 in a second.
const FRAME_INTERVAL: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// The drawing thread looks this often whether there is something to do.
const PATIENCE: Duration = Duration::from_millis(10);

/// A thread is waited for this long in the end.
const FAREWELL: Duration = Duration::from_millis(500);

/// Whether the terminal shows the view at the moment. There is one terminal, so there is one of these.
static SHOWN: AtomicBool = AtomicBool::new(false);

/// Why there is no view.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// There is nobody to look at it.
    #[error("{0} is not a terminal; expected to be started in one, without redirection")]
    NoTerminal(&'static str),
    /// Whoever takes the terminal from the background is halted by the system, and hears no signal.
    #[error(
        "this program is in the background of its terminal; expected in the foreground: without &, and with timeout --foreground"
    )]
    Background,
    /// The terminal does not do what is needed.
    #[error("the terminal cannot be used: {0}")]
    Terminal(#[from] io::Error),
}

/// A view on the terminal. Standard error is drawn on, so that results can be written to standard output.
/// The terminal is as before when this is dropped, and before a panic is told.
pub struct View {
    shared: Arc<Shared>,
    actions: Receiver<Action>,
    /// It ends when the view is closed or the terminal fails.
    thread: Option<JoinHandle<io::Result<()>>>,
    shown: Option<Instant>,
}

struct Shared {
    /// The newest snapshot that is not drawn yet.
    newest: Mutex<Option<Snapshot>>,
    /// Whether the view is to end.
    closing: AtomicBool,
    /// Whether whoever watches wants to leave.
    quit: Arc<AtomicBool>,
}

impl View {
    /// Whether there is a terminal to show something on.
    ///
    /// # Errors
    /// When standard input or standard error is none, or this program is in its background.
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

    /// Takes the terminal. `quit` is raised when whoever watches wants to leave, and ends
    /// [`wait_for_quit`](Self::wait_for_quit) when something else raises it.
    ///
    /// # Errors
    /// When there is no terminal, or it cannot be used.
    pub fn open(quit: &Arc<AtomicBool>) -> Result<Self, ViewError> {
        Self::check_terminal()?;
        let shared = Arc::new(Shared {
            newest: Mutex::new(None),
            closing: AtomicBool::new(false),
            quit: Arc::clone(quit),
        });
        restore_on_panic(Arc::clone(&shared));
        let (sender, actions) = channel();
        // From here on, dropping it gives the terminal back, whatever fails.
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

    /// Shows what `snapshot` makes, unless one was shown hardly before. It does not wait for the terminal.
    pub fn show(&mut self, snapshot: impl FnOnce() -> Snapshot) {
        let now = Instant::now();
        if self.shown.is_some_and(|shown| now - shown < FRAME_INTERVAL) {
            return;
        }
        self.shown = Some(now);
        // The other thread holds the lock no longer than it takes to take a snapshot out.
        if let Ok(mut newest) = self.shared.newest.try_lock() {
            *newest = Some(snapshot());
        }
    }

    /// What whoever watches wanted done since the last call, quitting aside.
    pub fn actions(&self) -> impl Iterator<Item = Action> {
        self.actions.try_iter()
    }

    /// Shows `snapshot` until whoever watches wants to leave.
    pub fn wait_for_quit(&mut self, snapshot: Snapshot) {
        let newest = self.shared.newest.lock();
        *newest.unwrap_or_else(PoisonError::into_inner) = Some(snapshot);
        while self.is_open() && !self.shared.quit.load(Ordering::Relaxed) {
            thread::sleep(PATIENCE);
        }
    }

    /// Whether the terminal still shows what it is given.
    pub fn is_open(&self) -> bool {
        self.thread
            .as_ref()
            .is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.shared.closing.store(true, Ordering::Relaxed);
        // Where the terminal went away, crossterm reads on for ever; where it takes nothing any more, writing
        // waits for ever. The threads are left to end with the program then, and nobody is there to be told.
        wait_for(self.thread.as_ref());
        match thread::Builder::new().spawn(restore) {
            Ok(restoring) => wait_for(Some(&restoring)),
            Err(_) => restore(),
        }
    }
}

/// Waits for `thread` to end, but not for ever.
fn wait_for<T>(thread: Option<&JoinHandle<T>>) {
    let start = Instant::now();
    while thread.is_some_and(|thread| !thread.is_finished()) && start.elapsed() < FAREWELL {
        thread::sleep(PATIENCE);
    }
}

/// Whether another program has the terminal that would be drawn on.
#[cfg(target_os = "linux")]
fn is_in_background() -> bool {
    let foreground = rustix::termios::tcgetpgrp(stderr());
    // A terminal that is not this session's own halts nobody.
    foreground.is_ok_and(|foreground| foreground != rustix::process::getpgrp())
}

/// Whether another program has the terminal that would be drawn on; not known here.
#[cfg(not(target_os = "linux"))]
fn is_in_background() -> bool {
    false
}

/// Gives the terminal back, if the view has it.
fn restore() {
    if SHOWN.swap(false, Ordering::Relaxed) {
        // As above: a terminal that went away.
        let _ = disable_raw_mode();
        let _ = execute!(stderr(), LeaveAlternateScreen, Show);
    }
}

/// Has a panic of any thread told on the terminal as it was before.
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

/// Waits a little for keys and passes on what they mean; whether the screen has another size now.
fn read_events(shared: &Shared, actions: &Sender<Action>) -> io::Result<bool> {
    let mut resized = false;
    let mut patience = PATIENCE;
    while event::poll(patience)? {
        patience = Duration::ZERO;
        let event = event::read()?;
        resized |= matches!(event, Event::Resize(..));
        match Action::of(&event) {
            Some(Action::Quit) => shared.quit.store(true, Ordering::Relaxed),
            // Nobody listens any more once the view is being closed.
            Some(action) => drop(actions.send(action)),
            None => {}
        }
    }
    Ok(resized)
}
