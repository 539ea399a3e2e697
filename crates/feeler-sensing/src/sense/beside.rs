//! What is said on standard error while frames are sensed: progress, where it is a terminal, and warnings.

use feeler_console::Warnings;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{Write, stderr};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two drawings of the progress.
pub const INTERVAL: Duration = Duration::from_millis(100);

/// How long the end waits for a terminal that is paused.
const LAST: Duration = Duration::from_secs(1);

/// Progress and warnings.
pub enum Beside {
    /// Shown at once, however long that takes.
    Waiting(ProgressBar),
    /// Shown by threads of their own: a hand waits for what is sensed.
    Aside(Aside),
}

/// Progress and warnings that hold nobody up.
pub struct Aside {
    progress: Arc<Mutex<String>>,
    /// Dropped to take the progress off the screen.
    stop: Mutex<Option<Sender<()>>>,
    /// Ends when it is off.
    ended: Mutex<Receiver<()>>,
    warnings: Warnings,
}

impl Beside {
    /// The progress is hidden unless standard error is a terminal.
    pub fn new(waits: bool) -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        match waits {
            true => Self::Waiting(bar),
            false => Self::Aside(Aside::new(&bar)),
        }
    }

    /// Shows the progress.
    pub fn progress(&self, line: String) {
        match self {
            Self::Waiting(bar) => {
                bar.set_message(line);
                bar.tick();
            }
            Self::Aside(aside) => *lock(&aside.progress) = line,
        }
    }

    /// Says something.
    pub fn say(&self, line: &str) {
        match self {
            Self::Waiting(bar) => say_beside(bar, line),
            Self::Aside(aside) => aside.warnings.queue(line),
        }
    }

    /// The same as [`say`](Self::say), for somebody else to call.
    pub fn sayer(&self) -> Box<dyn FnMut(&str) + Send> {
        match self {
            Self::Waiting(bar) => {
                let bar = bar.clone();
                Box::new(move |line| say_beside(&bar, line))
            }
            Self::Aside(aside) => aside.warnings.warn(),
        }
    }

    /// Takes the progress off the screen.
    pub fn clear(&self) {
        match self {
            Self::Waiting(bar) => bar.finish_and_clear(),
            Self::Aside(aside) => {
                drop(lock(&aside.stop).take());
                // Nothing is sent: it is off, or takes too long.
                let _ = lock(&aside.ended).recv_timeout(LAST);
            }
        }
    }
}

impl Aside {
    fn new(bar: &ProgressBar) -> Self {
        let progress = Arc::new(Mutex::new(String::new()));
        let (stop, stopped) = channel();
        let (ends, ended) = channel();
        let draw = {
            let (progress, bar) = (Arc::clone(&progress), bar.clone());
            move || {
                draw_until(&stopped, &progress, &bar);
                bar.finish_and_clear();
                drop(ends);
            }
        };
        // Without a thread there is no progress to see.
        let _ = thread::Builder::new().name("progress".into()).spawn(draw);
        let bar = bar.clone();
        Self {
            progress,
            stop: Mutex::new(Some(stop)),
            ended: Mutex::new(ended),
            warnings: Warnings::shown_by(move |line| say_beside(&bar, line)),
        }
    }
}

fn draw_until(stopped: &Receiver<()>, progress: &Mutex<String>, bar: &ProgressBar) {
    while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
        let line = lock(progress).clone();
        bar.set_message(line);
        bar.tick();
    }
}

fn say_beside(bar: &ProgressBar, line: &str) {
    // Where nobody listens, the table says what there is.
    bar.suspend(|| {
        let _ = writeln!(stderr(), "{line}");
    });
}

fn lock<T>(value: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
