//! Messages on standard error during sensing: warnings and, on a terminal, the progress.

use feeler_console::Warnings;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{Write, stderr};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two updates of the progress line.
pub const INTERVAL: Duration = Duration::from_millis(100);

/// Maximum time to wait for a paused terminal when sensing ends.
const LAST: Duration = Duration::from_secs(1);

/// Printer of progress and warnings.
pub enum ConsoleReporter {
    /// Prints synchronously; may block.
    Waiting(ProgressBar),
    /// Prints on background threads, because a hand depends on the readings.
    BackgroundReporter(BackgroundReporter),
}

/// Printer of progress and warnings that never blocks the caller.
pub struct BackgroundReporter {
    progress: Arc<Mutex<String>>,
    /// Dropped to remove the progress line.
    stop: Mutex<Option<Sender<()>>>,
    /// Disconnected once the progress line is removed.
    ended: Mutex<Receiver<()>>,
    warnings: Warnings,
}

impl ConsoleReporter {
    /// Creates a reporter that may block on the terminal if `waits`. Progress is hidden unless standard error is a
    /// terminal.
    pub fn new(waits: bool) -> Self {
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        match waits {
            true => Self::Waiting(bar),
            false => Self::BackgroundReporter(BackgroundReporter::new(&bar)),
        }
    }

    /// Shows the progress.
    pub fn progress(&self, line: String) {
        match self {
            Self::Waiting(bar) => {
                bar.set_message(line);
                bar.tick();
            }
            Self::BackgroundReporter(aside) => *lock(&aside.progress) = line,
        }
    }

    /// Prints a line.
    pub fn say(&self, line: &str) {
        match self {
            Self::Waiting(bar) => print_line(bar, line),
            Self::BackgroundReporter(aside) => aside.warnings.queue(line),
        }
    }

    /// Returns a function that prints lines from another thread.
    pub fn printer(&self) -> Box<dyn FnMut(&str) + Send> {
        match self {
            Self::Waiting(bar) => {
                let bar = bar.clone();
                Box::new(move |line| print_line(&bar, line))
            }
            Self::BackgroundReporter(aside) => aside.warnings.warn(),
        }
    }

    /// Removes the progress line.
    pub fn clear(&self) {
        match self {
            Self::Waiting(bar) => bar.finish_and_clear(),
            Self::BackgroundReporter(aside) => {
                drop(lock(&aside.stop).take());
                // Nothing is ever sent: this returns when the line is removed, or after the time limit.
                let _ = lock(&aside.ended).recv_timeout(LAST);
            }
        }
    }
}

impl BackgroundReporter {
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
        // Without a thread, there is no progress line.
        let _ = thread::Builder::new().name("progress".into()).spawn(draw);
        let bar = bar.clone();
        Self {
            progress,
            stop: Mutex::new(Some(stop)),
            ended: Mutex::new(ended),
            warnings: Warnings::shown_by(move |line| print_line(&bar, line)),
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

fn print_line(bar: &ProgressBar, line: &str) {
    // Ignore a closed standard error.
    bar.suspend(|| {
        let _ = writeln!(stderr(), "{line}");
    });
}

fn lock<T>(value: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
